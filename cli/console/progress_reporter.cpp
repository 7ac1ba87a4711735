#include "cli/console/progress_reporter.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/console/text.h"

namespace rayfield::cli {
namespace {

// Atomic, as the handler runs in one thread and all of them read it; without a lock, as a handler must not wait.
std::atomic<bool> g_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int signal_number) {
  if (g_interrupted.exchange(true)) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
}

std::string count_text(double count) {
  if (count >= 1e9) return fmt::format("{:.2f} G", count / 1e9);
  if (count >= 1e6) return fmt::format("{:.1f} M", count / 1e6);
  if (count >= 1e4) return fmt::format("{:.0f} k", count / 1e3);
  return fmt::format("{:.0f} ", count);
}

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

ProgressReporter::ProgressReporter(ProgressStyle style, bool quiet) : style_(style) {
  if (style_ == ProgressStyle::automatic) style_ = isatty(STDERR_FILENO) ? ProgressStyle::bar : ProgressStyle::plain;
  if (quiet) style_ = ProgressStyle::none;
}

ProgressReporter::~ProgressReporter() { finish(); }

bool ProgressReporter::cancelled() const { return g_interrupted.load(std::memory_order_relaxed); }

void ProgressReporter::stage(std::string_view name, std::uint64_t total, std::string_view unit) {
  finish();
  const std::lock_guard lock(mutex_);
  name_ = name, unit_ = unit, total_ = total, done_ = 0;
  started_ = drawn_ = Clock::now();
  open_ = true;
}

void ProgressReporter::advance(std::uint64_t count) {
  const std::lock_guard lock(mutex_);
  done_ += count;
  const auto interval =
      style_ == ProgressStyle::bar ? std::chrono::milliseconds(200) : std::chrono::milliseconds(10000);
  if (Clock::now() - drawn_ >= interval) draw(false);
}

void ProgressReporter::warn(std::string_view message) {
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::json) {
    const nlohmann::ordered_json line = {{"event", "warning"}, {"message", std::string(message)}};
    fmt::print(stderr, "{}\n", line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else if (style_ != ProgressStyle::none) {
    fmt::print(stderr, "{}warning: {}\n", style_ == ProgressStyle::bar && open_ ? "\r\x1b[K" : "",
               printable(std::string(message)));
  }
}

void ProgressReporter::finish() {
  const std::lock_guard lock(mutex_);
  if (open_) draw(true);
  open_ = false;
}

std::string ProgressReporter::status_text(double seconds) const {
  std::string text = total_ > 0 ? fmt::format("{} of {}{}", count_text(static_cast<double>(done_)),
                                              count_text(static_cast<double>(total_)), unit_)
                                : fmt::format("{}{}", count_text(static_cast<double>(done_)), unit_);
  if (seconds > 0.05 && done_ > 0)
    text += fmt::format(", {}{}/s", count_text(static_cast<double>(done_) / seconds), unit_);
  return text;
}

void ProgressReporter::draw(bool final) {
  drawn_ = Clock::now();
  const double seconds = std::chrono::duration<double>(drawn_ - started_).count();
  switch (style_) {
    case ProgressStyle::json: {
      nlohmann::ordered_json line = {{"event", final ? "stage_done" : "progress"},
                                     {"stage", name_},
                                     {"done", done_},
                                     {"total", total_},
                                     {"unit", unit_},
                                     {"seconds", seconds}};
      fmt::print(stderr, "{}\n", line.dump());
      break;
    }
    case ProgressStyle::bar: {
      std::string left;
      if (!final && total_ > 0 && done_ > 0) {
        const double rest =
            seconds * static_cast<double>(total_ - std::min(done_, total_)) / static_cast<double>(done_);
        left = fmt::format(", {:.0f} s left", rest);
      }
      fmt::print(stderr, "\r\x1b[K{:<28} {}{}{}", name_, status_text(seconds), left,
                 final ? fmt::format(", {:.1f} s\n", seconds) : "");
      break;
    }
    case ProgressStyle::plain:
      fmt::print(stderr, "{}: {}, {:.1f} s{}\n", name_, status_text(seconds), seconds, final ? "" : " …");
      break;
    default:
      break;
  }
  std::fflush(stderr);
}

}  // namespace rayfield::cli
