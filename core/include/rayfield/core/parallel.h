#pragma once

#include <cstddef>
#include <functional>

#include "rayfield/core/result.h"

/// parallel: work on several threads by OpenMP, which no other file uses directly: order, errors and results do not
/// depend on the number of threads. Called from inside a task, these functions run in the calling thread.
namespace rayfield {

/// `requested` if positive, else the number of processors this process may use.
int thread_count(int requested);

/// Calls task(index, worker) for index 0…count-1 from up to `threads` workers (0 ≤ worker < threads), each index
/// exactly once, indices taken in increasing order. After an error no higher index is begun; the error with the lowest
/// index is returned. `threads` ≤ 1 runs in the calling thread. Exceptions become ErrorCode::internal,
/// std::bad_alloc becomes ErrorCode::resources.
Result<void> parallel_for(std::size_t count, int threads,
                          const std::function<Result<void>(std::size_t index, int worker)>& task);

/// The same for tasks that have no errors of their own. Throws what a task throws.
void parallel_each(std::size_t count, int threads, const std::function<void(std::size_t index, int worker)>& task);

/// Calls work(worker) once in each of up to `threads` workers, which divide the work among themselves, and waits for
/// all of them. There may be fewer workers than requested. Throws what one of them throws.
void parallel_team(int threads, const std::function<void(int worker)>& work);

/// Ordered reduction: produce(i, worker) runs in parallel, consume(i) is called for i = 0, 1, 2 … in that order, one
/// at a time, each after its produce(i). At most `window` items are produced ahead of the consumer, which bounds
/// memory. Whatever consume() adds up is therefore the same at any thread count.
Result<void> parallel_ordered(std::size_t count, int threads, std::size_t window,
                              const std::function<Result<void>(std::size_t index, int worker)>& produce,
                              const std::function<Result<void>(std::size_t index)>& consume);

}  // namespace rayfield
