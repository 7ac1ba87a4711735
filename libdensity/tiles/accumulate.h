#pragma once

#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

/// tiles: what all stages share: reading a tile chunk by chunk, sums that do not depend on their order, and stored
/// derived data.
namespace rayfield::density {

/// ErrorCode::interrupted once the user asked to stop.
Result<void> check_cancelled(const Progress& progress);

/// How many of `threads` are of use for a tile, at least one.
int chunk_workers(const tile::Store::TileReader& reader, int threads);

/// Reads every chunk of a tile once and passes it on, from up to `workers` workers (0 ≤ worker < workers). Asks before
/// every chunk whether to stop. `every`: only each n-th chunk, from the first on. Errors: those of the reader and of
/// `add`; interrupted.
Result<void> for_chunks(const tile::Store::TileReader& reader, int workers, const Progress& progress,
                        const std::function<Result<void>(const tile::SegmentBatch& segments, int worker)>& add,
                        std::size_t every = 1);

/// Calls what returns nothing or a Result<void>.
template <class Call>
Result<void> as_result(Call&& call) {
  if constexpr (std::is_void_v<std::invoke_result_t<Call>>) {
    std::forward<Call>(call)();
    return {};
  } else {
    return std::forward<Call>(call)();
  }
}

/// Feeds every chunk of a tile to one of several accumulators (copies of `empty`, one per worker) by
/// add(accumulator, segments) and merges them by Accumulator::merge(). Both are independent of the order of calls, so
/// the sum is the same at any number of threads.
template <class Accumulator, class Add>
Result<Accumulator> accumulate_tile(const tile::Store::TileReader& reader, Accumulator empty, int threads,
                                    const Progress& progress, const Add& add, std::size_t every = 1) {
  const int workers = chunk_workers(reader, threads);
  std::vector<Accumulator> parts;
  parts.reserve(static_cast<std::size_t>(workers));
  for (int worker = 1; worker < workers; ++worker) parts.push_back(empty);
  parts.push_back(std::move(empty));
  RAYFIELD_CHECK(for_chunks(
      reader, workers, progress,
      [&](const tile::SegmentBatch& segments, int worker) {
        return as_result([&] { return add(parts[worker], segments); });
      },
      every));
  for (std::size_t part = 1; part < parts.size(); ++part)
    RAYFIELD_CHECK(as_result([&] { return parts[0].merge(parts[part]); }));
  return std::move(parts[0]);
}
template <class Accumulator>
Result<Accumulator> accumulate_tile(const tile::Store::TileReader& reader, Accumulator empty, int threads,
                                    const Progress& progress) {
  return accumulate_tile(reader, std::move(empty), threads, progress,
                         [](Accumulator& sum, const tile::SegmentBatch& segments) { return sum.add(segments); });
}

}  // namespace rayfield::density
