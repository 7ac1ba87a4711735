#include "rayfield/core/parallel.h"

#include <omp.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <vector>

#include "core/parallel/thread_sanitizer.h"

namespace rayfield {
namespace {

// Runs a task and turns what it throws into a value: no exception may leave an OpenMP region.
template <class F>
Result<void> guarded(F&& task) {
  try {
    return task();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::resources, "out of memory", "", "an allocation failed",
                "give a smaller --memory or fewer --threads");
  } catch (const std::exception& e) {
    return fail(ErrorCode::internal, "internal error", "", e.what(), "please report this with the command line");
  }
}

// The state of parallel_ordered(): workers take the lowest index that is not taken, within the window, and whoever is
// free consumes the next item in order.
class OrderedWork {
 public:
  OrderedWork(std::size_t count, std::size_t window, const std::function<Result<void>(std::size_t, int)>& produce,
              const std::function<Result<void>(std::size_t)>& consume)
      : count_(count),
        window_(std::max<std::size_t>(window, 1)),
        produce_(produce),
        consume_(consume),
        done_(count, 0) {}

  // A worker prefers to consume what is due; else it produces within the window; else it waits.
  void work(int worker) {
    std::unique_lock lock(mutex_);
    while (errors_.empty() && next_consume_ < count_) {
      if (!consuming_ && done_[next_consume_] != 0) {
        consume_next(lock);
      } else if (next_produce_ < count_ && next_produce_ - next_consume_ < window_) {
        produce_next(lock, worker);
      } else {
        changed_.wait(lock);
      }
    }
  }

  Result<void> result() {
    if (!errors_.empty()) return tl::make_unexpected(errors_.begin()->second);
    return {};
  }

 private:
  void consume_next(std::unique_lock<std::mutex>& lock) {
    const std::size_t i = next_consume_;
    consuming_ = true;
    lock.unlock();
    Result<void> result = guarded([&] { return consume_(i); });
    lock.lock();
    consuming_ = false;
    next_consume_ = i + 1;
    if (!result) errors_.emplace(i, std::move(result).error());
    changed_.notify_all();
  }
  void produce_next(std::unique_lock<std::mutex>& lock, int worker) {
    const std::size_t i = next_produce_++;
    lock.unlock();
    Result<void> result = guarded([&] { return produce_(i, worker); });
    lock.lock();
    if (result)
      done_[i] = 1;
    else
      errors_.emplace(i, std::move(result).error());
    changed_.notify_all();
  }

  const std::size_t count_, window_;
  const std::function<Result<void>(std::size_t, int)>& produce_;
  const std::function<Result<void>(std::size_t)>& consume_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::size_t next_produce_ = 0, next_consume_ = 0;
  bool consuming_ = false;
  std::vector<char> done_;
  std::map<std::size_t, Error> errors_;  // by index; the lowest counts
};

// What a team shares.
struct Team {
  const std::function<void(int worker)>& work;
  std::mutex mutex = {};
  std::exception_ptr thrown = {};  // guarded by mutex while the team runs
};

// One member of the team.
__attribute__((noinline)) void run_worker(Team& team, int worker) {
  tsan::after_fork();
  try {
    team.work(worker);
  } catch (...) {
    const std::scoped_lock lock(team.mutex);
    if (!team.thrown) team.thrown = std::current_exception();
  }
  tsan::before_join();
}

// The one parallel region. What the compiler passes to it is read before any mark can be set: it is left out of
// ThreadSanitizer's sight.
RAYFIELD_NO_TSAN void run_team(Team& team, int threads) {
#pragma omp parallel num_threads(threads)
  run_worker(team, omp_get_thread_num());
}

}  // namespace

int thread_count(int requested) {
  if (requested > 0) return requested;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof(set), &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
  return std::max(1, omp_get_num_procs());
}

void parallel_team(int threads, const std::function<void(int worker)>& work) {
  if (threads <= 1) return work(0);
  Team team{work};
  tsan::before_fork();
  run_team(team, threads);
  tsan::after_join();
  if (team.thrown) std::rethrow_exception(team.thrown);
}

Result<void> parallel_for(std::size_t count, int threads, const std::function<Result<void>(std::size_t, int)>& task) {
  threads = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), count));
  if (threads <= 1) {
    for (std::size_t i = 0; i < count; ++i) RAYFIELD_CHECK(guarded([&] { return task(i, 0); }));
    return {};
  }
  std::atomic<std::size_t> lowest_failed = count;
  std::mutex mutex;
  std::map<std::size_t, Error> errors;
  parallel_team(threads, [&](int worker) {
  // Indices are handed out in increasing order. What comes before a failure is still done, so that the error with the
  // lowest index is found whatever the timing.
#pragma omp for schedule(monotonic : dynamic, 1) nowait
    for (std::size_t i = 0; i < count; ++i) {
      if (i > lowest_failed.load(std::memory_order_relaxed)) continue;
      Result<void> result = guarded([&] { return task(i, worker); });
      if (result) continue;
      const std::scoped_lock lock(mutex);
      errors.emplace(i, std::move(result).error());
      lowest_failed = errors.begin()->first;
    }
  });
  if (!errors.empty()) return tl::make_unexpected(errors.begin()->second);
  return {};
}

void parallel_each(std::size_t count, int threads, const std::function<void(std::size_t, int)>& task) {
  std::mutex mutex;
  std::exception_ptr thrown;
  (void)parallel_for(count, threads, [&](std::size_t index, int worker) -> Result<void> {
    try {
      task(index, worker);
      return {};
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!thrown) thrown = std::current_exception();
      return fail(ErrorCode::internal, "internal error", "", "a task threw");  // stops the others
    }
  });
  if (thrown) std::rethrow_exception(thrown);
}

Result<void> parallel_ordered(std::size_t count, int threads, std::size_t window,
                              const std::function<Result<void>(std::size_t, int)>& produce,
                              const std::function<Result<void>(std::size_t)>& consume) {
  if (threads <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) {
      RAYFIELD_CHECK(guarded([&] { return produce(i, 0); }));
      RAYFIELD_CHECK(guarded([&] { return consume(i); }));
    }
    return {};
  }
  OrderedWork work(count, window, produce, consume);
  parallel_team(threads, [&](int worker) { work.work(worker); });
  return work.result();
}

}  // namespace rayfield
