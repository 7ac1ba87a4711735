#include "rayfield/slam/unwarp.h"

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "libslam/input/read_ahead.h"
#include "libslam/unwarp/unwarper.h"
#include "rayfield/core/bounded_queue.h"

namespace rayfield::slam {
namespace {

constexpr std::size_t kAhead = 4;  // batches that may wait for the consumer

// A log reader pushes, a RaySource is pulled: a thread reads the log into a short queue.
class UnwarpSource : public RaySource {
 public:
  UnwarpSource(LogReader read, const Rig& rig, std::shared_ptr<const Trajectory> trajectory,
               const SensorOffsets& offsets, std::string name)
      : read_(std::move(read)),
        rig_(rig),
        trajectory_(std::move(trajectory)),
        offsets_(offsets),
        name_(std::move(name)) {}
  ~UnwarpSource() override { stop(); }

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    if (!queue_) start();
    while (batch.size() < max_rays) {
      if (next_ == front_.size()) {
        RAYFIELD_ASSIGN(const bool more, pop());
        if (!more) break;
      }
      const std::size_t end = std::min(front_.size(), next_ + max_rays - batch.size());
      for (; next_ < end; ++next_)
        batch.push(front_.origin[next_], front_.end[next_], front_.time_s[next_], front_.intensity[next_],
                   front_.hit[next_] != 0);
    }
    return batch.size();
  }

  Result<bool> rewind() override {
    stop();
    queue_.reset(), front_.clear();
    next_ = 0;
    return true;
  }

  std::string name() const override { return name_; }

  std::vector<std::string> warnings() const override {
    const std::scoped_lock lock(mutex_);
    return counts_.lines();
  }

 private:
  void start() {
    queue_ = std::make_unique<BoundedQueue<RayBatch>>(kAhead);
    worker_ = std::thread([this] { queue_->end(produce()); });
  }

  void stop() {
    if (queue_) queue_->abandon();
    if (worker_.joinable()) worker_.join();
  }

  // The next batch into front_; false at the end of the log.
  Result<bool> pop() {
    std::optional<RayBatch> next = queue_->pop();
    if (!next) {
      RAYFIELD_CHECK(queue_->result());
      return false;
    }
    front_ = std::move(*next);
    next_ = 0;
    return true;
  }

  // In the worker's thread.
  Result<void> produce() try {
    Unwarper unwarper(rig_, *trajectory_, offsets_, [this](const RayBatch& batch) -> Result<void> {
      if (queue_->push(RayBatch(batch))) return {};
      return fail(ErrorCode::interrupted, "stopped", name_, "the reader of the rays ended");
    });
    const Result<void> read = read_ahead(read_, unwarper, 2);
    const Result<void> finished = unwarper.finish();
    {
      const std::scoped_lock lock(mutex_);
      counts_ = unwarper.counts();
    }
    return read ? finished : read;
  } catch (const std::exception& e) {
    return fail(ErrorCode::internal, "cannot unwarp", name_, e.what());
  }

  LogReader read_;
  Rig rig_;
  std::shared_ptr<const Trajectory> trajectory_;
  SensorOffsets offsets_;
  std::string name_;

  std::unique_ptr<BoundedQueue<RayBatch>> queue_;  // while the log is read
  std::thread worker_;
  mutable std::mutex mutex_;
  UnwarpCounts counts_;  // guarded by mutex_
  RayBatch front_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<RaySource> open_unwarped(LogReader read, const Rig& rig, std::shared_ptr<const Trajectory> trajectory,
                                         const SensorOffsets& offsets, std::string name) {
  return std::make_unique<UnwarpSource>(std::move(read), rig, std::move(trajectory), offsets, std::move(name));
}

}  // namespace rayfield::slam
