#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "rayfield/core/progress.h"

namespace rayfield::cli {

enum class ProgressStyle { automatic, bar, plain, json, none };

/// Progress on stderr. bar: one line redrawn, with rate and time left; plain: a line per stage and every ten seconds;
/// json: one JSON object a line. SIGINT and SIGTERM set cancelled().
class ProgressReporter : public Progress {
 public:
  ProgressReporter(ProgressStyle style, bool quiet);
  ~ProgressReporter() override;
  ProgressReporter(const ProgressReporter&) = delete;
  ProgressReporter& operator=(const ProgressReporter&) = delete;

  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override;
  void advance(std::uint64_t count) override;
  void warn(std::string_view message) override;
  bool cancelled() const override;

  /// Ends the current stage's line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(bool final);
  std::string status_text(double seconds) const;

  ProgressStyle style_;
  std::mutex mutex_;
  std::string name_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
  Clock::time_point started_, drawn_;
  bool open_ = false;
};

/// Installs handlers that make every ProgressReporter report cancelled() from then on; a second signal ends the
/// process at once.
void install_interrupt_handlers();

}  // namespace rayfield::cli
