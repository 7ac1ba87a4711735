// Attacks on a store that has been filled by the program, for tests/torture:
//   store_damage flip STORE RUNS SEED     damages its files and uses them (damage_campaign.h); the store is whole again
//   store_damage reseal STORE SEED        changes something and makes all digests fit (reseal.h); the store stays so
// `flip` prints "KIND RUNS" for each kind of file, then what was found, one per line; a crash is a finding. `reseal`
// prints what it has changed. Exit code 1 where something was found, 2 for wrong usage.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fault/damage_campaign.h"
#include "tests/fault/reseal.h"

namespace {

namespace fs = std::filesystem;
using namespace rayfield::tile::testing;

constexpr std::size_t kRunsOfOneProcess = 1000;
// Of one process; a hang is a crash. The clock allows for a machine that does other things.
constexpr unsigned kMostCpuSeconds = 120, kMostSeconds = 1800;

// What a process is at, for the one that looks after it.
struct Shared {
  char doing[4096];
};

void print(const DamageTally& tally) {
  for (const auto& [kind, runs] : tally.damages) std::printf("%s %zu\n", kind.c_str(), runs);
  for (const std::string& finding : tally.findings) std::printf("%s\n", finding.c_str());
  std::fflush(stdout);
}

// In a process of its own, since what is looked for may kill it. Returns whether nothing was found.
bool run_some(const DamageCampaign& campaign, std::size_t runs, std::uint64_t seed, Shared& shared) {
  std::fflush(stdout);  // or both would print it
  const ::pid_t child = ::fork();
  if (child < 0) return std::perror("store_damage: fork"), false;
  if (child == 0) {
    const ::rlimit limit{kMostCpuSeconds, kMostCpuSeconds};
    ::setrlimit(RLIMIT_CPU, &limit);
    ::alarm(kMostSeconds);
    const DamageTally tally = campaign.run(runs, seed, [&shared](const std::string& what) {
      std::strncpy(shared.doing, what.c_str(), sizeof shared.doing - 1);
    });
    print(tally);
    ::_exit(tally.findings.empty() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  if (!WIFEXITED(status)) std::printf("crashed: signal %d: %s\n", WTERMSIG(status), shared.doing);
  campaign.restore();
  return false;
}

int flip(const fs::path& store, std::size_t runs, std::uint64_t seed) {
  void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return std::perror("store_damage: mmap"), 2;
  const DamageCampaign campaign(store, store.string() + "-spare");
  bool good = true;
  for (std::size_t done = 0; done < runs; done += kRunsOfOneProcess)
    good = run_some(campaign, std::min(kRunsOfOneProcess, runs - done), seed + done, *static_cast<Shared*>(memory)) &&
           good;
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb == "flip" && argc == 5)
    return flip(argv[2], std::strtoul(argv[3], nullptr, 10), std::strtoull(argv[4], nullptr, 10));
  if (verb == "reseal" && argc == 4) {
    std::mt19937_64 random(std::strtoull(argv[3], nullptr, 10));
    std::printf("%s\n", reseal_changed(argv[2], random).c_str());
    return 0;
  }
  std::fputs("usage: store_damage flip STORE RUNS SEED | reseal STORE SEED\n", stderr);
  return 2;
}
