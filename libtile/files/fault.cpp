#include "libtile/files/fault.h"

#ifdef RAYFIELD_FAULT_POINTS

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>

namespace rayfield::tile::fault {
namespace {

struct Plan {
  bool active = false;
  bool any_point = false;
  bool kill = true;
  std::string name;
  long passage = 0;
};

Plan read_plan() {
  Plan plan;
  const char* text = std::getenv("RAYFIELD_FAULT");
  if (text == nullptr) return plan;
  const std::string spec = text;
  const std::size_t first = spec.find(':');
  if (first == std::string::npos) return plan;
  const std::size_t second = spec.find(':', first + 1);
  plan.name = spec.substr(0, first);
  plan.any_point = plan.name == "*";
  plan.passage = std::strtol(spec.substr(first + 1, second - first - 1).c_str(), nullptr, 10);
  plan.kill = second == std::string::npos || spec.substr(second + 1) != "enospc";
  plan.active = plan.passage > 0;
  return plan;
}

}  // namespace

int point(const char* name) {
  static const Plan kPlan = read_plan();
  if (!kPlan.active) return 0;
  if (!kPlan.any_point && kPlan.name != name) return 0;
  static std::atomic<long> passages{0};
  if (++passages != kPlan.passage) return 0;
  if (kPlan.kill) std::raise(SIGKILL);
  return ENOSPC;
}

}  // namespace rayfield::tile::fault

#endif
