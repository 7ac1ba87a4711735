#include <algorithm>

#include "rayfield/core/parallel.h"
#include "rayfield/sim/simulate.h"
#include "sim/scan/scanner.h"

namespace rayfield::sim {
namespace {

// Renders as many chunks at a time as there are threads, and hands their rays out.
class SimulatedRays : public RaySource {
 public:
  SimulatedRays(Scanner scanner, std::string name, int threads)
      : scanner_(std::move(scanner)), name_(std::move(name)), threads_(threads) {}

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    while (batch.size() < max_rays) {
      if (at_ray_ == current_rays()) {
        RAYFIELD_ASSIGN(const bool more, advance());
        if (!more) break;
        continue;
      }
      const RayBatch& from = chunks_[at_chunk_].rays;
      const std::size_t count = std::min(max_rays - batch.size(), from.size() - at_ray_);
      for (std::size_t i = at_ray_; i < at_ray_ + count; ++i)
        batch.push(from.origin[i], from.end[i], from.time_s[i], from.intensity[i], from.hit[i] != 0);
      at_ray_ += count;
    }
    return batch.size();
  }

  Result<bool> rewind() override {
    next_ = at_chunk_ = at_ray_ = 0;
    chunks_.clear();
    return true;
  }

  std::string name() const override { return name_; }

 private:
  Scanner scanner_;
  std::string name_;
  int threads_;
  std::vector<Scanner::Chunk> chunks_;
  std::size_t next_ = 0;  // first chunk that is not in chunks_
  std::size_t at_chunk_ = 0, at_ray_ = 0;

  std::size_t current_rays() const { return at_chunk_ < chunks_.size() ? chunks_[at_chunk_].rays.size() : at_ray_; }

  Result<bool> advance() {
    at_ray_ = 0;
    if (at_chunk_ + 1 < chunks_.size()) {
      ++at_chunk_;
      return true;
    }
    at_chunk_ = 0;
    const std::size_t count = std::min(static_cast<std::size_t>(threads_), scanner_.chunk_count() - next_);
    chunks_.assign(count, Scanner::Chunk());
    RAYFIELD_CHECK(parallel_for(count, threads_, [&](std::size_t i, int) -> Result<void> {
      scanner_.render(next_ + i, false, true, chunks_[i]);
      return {};
    }));
    next_ += count;
    return count > 0;
  }
};

}  // namespace

Result<std::unique_ptr<RaySource>> true_rays(const World& world, const Drive& drive, const SimulateOptions& options) {
  RAYFIELD_ASSIGN(Scanner scanner, Scanner::create(world, drive));
  return std::make_unique<SimulatedRays>(std::move(scanner), world.site().name + " " + world.date().label(),
                                         thread_count(options.threads));
}

}  // namespace rayfield::sim
