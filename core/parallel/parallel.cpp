#include "rayfield/core/parallel.h"

#include <sched.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <vector>

namespace rayfield {
namespace {

// Runs a task and turns what it throws into a value.
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

}  // namespace

int thread_count(int requested) {
  if (requested > 0) return requested;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof(set), &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

Result<void> parallel_for(std::size_t count, int threads, const std::function<Result<void>(std::size_t, int)>& task) {
  return parallel_ordered(count, threads, std::max<std::size_t>(count, 1), task,
                          [](std::size_t) -> Result<void> { return {}; });
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
  window = std::max<std::size_t>(window, 1);

  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next_produce = 0, next_consume = 0;
  bool consuming = false;
  std::vector<char> done(count, 0);
  std::map<std::size_t, Error> errors;

  // A worker prefers to consume what is due; else it produces within the window; else it waits.
  const auto work = [&](int worker) {
    std::unique_lock lock(mutex);
    while (true) {
      const bool failed = !errors.empty();
      if (!failed && !consuming && next_consume < count && done[next_consume]) {
        const std::size_t i = next_consume;
        consuming = true;
        lock.unlock();
        Result<void> result = guarded([&] { return consume(i); });
        lock.lock();
        consuming = false;
        next_consume = i + 1;
        if (!result) errors.emplace(i, std::move(result).error());
        changed.notify_all();
      } else if (!failed && next_produce < count && next_produce - next_consume < window) {
        const std::size_t i = next_produce++;
        lock.unlock();
        Result<void> result = guarded([&] { return produce(i, worker); });
        lock.lock();
        if (result) {
          done[i] = 1;
        } else {
          errors.emplace(i, std::move(result).error());
        }
        changed.notify_all();
      } else if (failed || (next_produce == count && next_consume == count)) {
        return;
      } else {
        changed.wait(lock);
      }
    }
  };

  std::vector<std::thread> workers;
  for (int worker = 1; worker < threads; ++worker) workers.emplace_back(work, worker);
  work(0);
  for (std::thread& thread : workers) thread.join();
  if (!errors.empty()) return tl::make_unexpected(errors.begin()->second);
  return {};
}

}  // namespace rayfield
