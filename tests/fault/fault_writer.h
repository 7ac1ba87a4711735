#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace rayfield::tile::testing {

namespace fs = std::filesystem;

/// What a run of store_fault_writer gave.
struct Outcome {
  bool killed = false;
  int code = -1;
  std::string message;
};

/// Runs store_fault_writer with a fault planned ("" = none).
inline Outcome run_writer(const fs::path& store, const std::string& what, const std::string& fault) {
  int output[2];
  if (::pipe(output) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(output[1], STDERR_FILENO);
    ::close(output[0]), ::close(output[1]);
    ::setenv("SOURCE_DATE_EPOCH", "1549843200", 1);
    if (fault.empty()) {
      ::unsetenv("RAYFIELD_FAULT");
    } else {
      ::setenv("RAYFIELD_FAULT", fault.c_str(), 1);
    }
    ::execl(RAYFIELD_FAULT_WRITER, RAYFIELD_FAULT_WRITER, store.c_str(), what.c_str(), nullptr);
    ::_exit(127);
  }
  ::close(output[1]);
  Outcome outcome;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = ::read(output[0], buffer.data(), buffer.size())) > 0;)
    outcome.message.append(buffer.data(), static_cast<std::size_t>(n));
  ::close(output[0]);
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("no child");
  outcome.killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  return outcome;
}

/// Flushing costs milliseconds on a disk and nothing in memory, and these tests flush some ten thousand times.
inline fs::path quick_folder() {
  const fs::path memory = "/dev/shm";
  return ::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path();
}

}  // namespace rayfield::tile::testing
