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

/// Take what was read, each worker its own.
using AddSegments = std::function<Result<void>(const tile::SegmentBatch& segments, int worker)>;
using AddHits = std::function<Result<void>(const tile::HitBatch& hits, int worker)>;

/// Reads every chunk of a tile once and passes it on, from up to `workers` workers (0 ≤ worker < workers). Asks before
/// every chunk whether to stop. `every`: only each n-th chunk, from the first on. Errors: those of the reader and of
/// `add`; interrupted.
Result<void> for_chunks(const tile::Store::TileReader& reader, int workers, const Progress& progress,
                        const AddSegments& add, std::size_t every = 1);
/// The same of the hits alone.
Result<void> for_hits(const tile::Store::TileReader& reader, int workers, const Progress& progress, const AddHits& add);

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

/// Copies of `empty`, one per worker, to which `feed(parts)` gives all that there is, merged by Accumulator::merge().
/// Both are independent of the order of calls, so the sum is the same at any number of threads.
template <class Accumulator, class Feed>
Result<Accumulator> accumulate(int workers, Accumulator empty, const Feed& feed) {
  std::vector<Accumulator> parts;
  parts.reserve(static_cast<std::size_t>(workers));
  for (int worker = 1; worker < workers; ++worker) parts.push_back(empty);
  parts.push_back(std::move(empty));
  RAYFIELD_CHECK(feed(parts));
  for (std::size_t part = 1; part < parts.size(); ++part)
    RAYFIELD_CHECK(as_result([&] { return parts[0].merge(parts[part]); }));
  return std::move(parts[0]);
}

/// Feeds every chunk of a tile to one of several accumulators by add(accumulator, segments).
template <class Accumulator, class Add>
Result<Accumulator> accumulate_tile(const tile::Store::TileReader& reader, Accumulator empty, int threads,
                                    const Progress& progress, const Add& add, std::size_t every = 1) {
  const int workers = chunk_workers(reader, threads);
  return accumulate(workers, std::move(empty), [&](std::vector<Accumulator>& parts) {
    return for_chunks(
        reader, workers, progress,
        [&](const tile::SegmentBatch& segments, int worker) {
          return as_result([&] { return add(parts[worker], segments); });
        },
        every);
  });
}
template <class Accumulator>
Result<Accumulator> accumulate_tile(const tile::Store::TileReader& reader, Accumulator empty, int threads,
                                    const Progress& progress) {
  return accumulate_tile(reader, std::move(empty), threads, progress,
                         [](Accumulator& sum, const tile::SegmentBatch& segments) { return sum.add(segments); });
}

/// The same of the hits alone, by Accumulator::add(hits). A tile in which nothing is of use, as Accumulator::empty()
/// says where there is one, is not read.
template <class Accumulator>
Result<Accumulator> accumulate_hits(const tile::Store::TileReader& reader, Accumulator empty, int threads,
                                    const Progress& progress) {
  if constexpr (requires { empty.empty(); })
    if (empty.empty()) return empty;
  const int workers = chunk_workers(reader, threads);
  return accumulate(workers, std::move(empty), [&](std::vector<Accumulator>& parts) {
    return for_hits(reader, workers, progress, [&](const tile::HitBatch& hits, int worker) {
      return as_result([&] { return parts[worker].add(hits); });
    });
  });
}

}  // namespace rayfield::density
