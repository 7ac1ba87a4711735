#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "rayfield/slam/unwarp.h"
#include "read_ahead.h"

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
    if (!worker_.joinable() && !ended_) worker_ = std::thread([this] { produce(); });
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
    queue_.clear(), front_.clear();
    next_ = 0, ended_ = false, stopping_ = false, done_.reset();
    return true;
  }

  std::string name() const override { return name_; }

  std::vector<std::string> warnings() const override {
    const std::scoped_lock lock(mutex_);
    return counts_.lines();
  }

 private:
  // The next batch into front_; false at the end of the log.
  Result<bool> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !queue_.empty() || done_.has_value(); });
    if (queue_.empty()) {
      ended_ = true;
      if (!*done_) return tl::make_unexpected(done_->error());
      return false;
    }
    front_ = std::move(queue_.front());
    queue_.pop_front();
    next_ = 0;
    changed_.notify_all();
    return true;
  }

  void produce() {
    Result<void> result;
    UnwarpCounts counts;
    try {
      Unwarper unwarper(rig_, *trajectory_, offsets_, [this](const RayBatch& batch) { return push(batch); });
      result = read_ahead(read_, unwarper, 2);
      const Result<void> finished = unwarper.finish();
      if (result && !finished) result = finished;
      counts = unwarper.counts();
    } catch (const std::exception& e) {
      result = fail(ErrorCode::internal, "cannot unwarp", name_, e.what());
    }
    const std::scoped_lock lock(mutex_);
    counts_ = counts;
    done_ = result;
    changed_.notify_all();
  }

  Result<void> push(const RayBatch& batch) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return queue_.size() < kAhead || stopping_; });
    if (stopping_) return fail(ErrorCode::interrupted, "stopped", name_, "the reader of the rays ended");
    queue_.push_back(batch);
    changed_.notify_all();
    return {};
  }

  void stop() {
    {
      const std::scoped_lock lock(mutex_);
      stopping_ = true;
      changed_.notify_all();
    }
    if (worker_.joinable()) worker_.join();
  }

  LogReader read_;
  Rig rig_;
  std::shared_ptr<const Trajectory> trajectory_;
  SensorOffsets offsets_;
  std::string name_;

  std::thread worker_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RayBatch> queue_;        // guarded by mutex_
  std::optional<Result<void>> done_;  // guarded by mutex_
  UnwarpCounts counts_;               // guarded by mutex_
  bool stopping_ = false;             // guarded by mutex_
  RayBatch front_;
  std::size_t next_ = 0;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<RaySource> open_unwarped(LogReader read, const Rig& rig, std::shared_ptr<const Trajectory> trajectory,
                                         const SensorOffsets& offsets, std::string name) {
  return std::make_unique<UnwarpSource>(std::move(read), rig, std::move(trajectory), offsets, std::move(name));
}

}  // namespace rayfield::slam
