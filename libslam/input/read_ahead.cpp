#include "libslam/input/read_ahead.h"

#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "rayfield/core/bounded_queue.h"

namespace rayfield::slam {
namespace {

constexpr std::size_t kBatchPoints = 16384;   // lidar points handed over at a time
constexpr std::size_t kBatchMessages = 1024;  // or messages, where there is no lidar
constexpr std::size_t kAhead = 8;             // batches that may wait

using Message = std::variant<ImuSample, GpsFix, SpinnerAngle, LidarScan>;
using Batch = std::vector<Message>;
using Queue = BoundedQueue<Batch>;

void deliver(const Message& message, SensorSink& sink) {
  if (const auto* imu = std::get_if<ImuSample>(&message)) sink.imu(*imu);
  if (const auto* gps = std::get_if<GpsFix>(&message)) sink.gps(*gps);
  if (const auto* angle = std::get_if<SpinnerAngle>(&message)) sink.spinner(*angle);
  if (const auto* scan = std::get_if<LidarScan>(&message)) sink.lidar(*scan);
}

// Collects messages into batches.
class Collector : public SensorSink {
 public:
  explicit Collector(Queue& queue) : queue_(queue) {}
  void imu(const ImuSample& sample) override { add(sample, 0); }
  void gps(const GpsFix& fix) override { add(fix, 0); }
  void spinner(const SpinnerAngle& angle) override { add(angle, 0); }
  void lidar(const LidarScan& scan) override { add(scan, scan.range_m.size()); }
  void flush() {
    if (!batch_.empty()) queue_.push(std::exchange(batch_, {}));
    points_ = 0;
  }

 private:
  template <class T>
  void add(const T& message, std::size_t points) {
    batch_.emplace_back(message);
    points_ += points;
    if (points_ >= kBatchPoints || batch_.size() >= kBatchMessages) flush();
  }
  Queue& queue_;
  Batch batch_;
  std::size_t points_ = 0;
};

void produce(const LogReader& read, Queue& queue) {
  try {
    Collector collector(queue);
    Result<void> result = read(collector);
    collector.flush();
    queue.end(std::move(result));
  } catch (const std::bad_alloc&) {
    queue.end(fail(ErrorCode::resources, "out of memory", "log", "an allocation failed"));
  } catch (const std::exception& e) {
    queue.end(fail(ErrorCode::internal, "cannot read", "log", e.what()));
  }
}

}  // namespace

Result<void> read_ahead(const LogReader& read, SensorSink& sink, int threads) {
  if (threads <= 1) return read(sink);
  Queue queue(kAhead);
  std::thread reader([&] { produce(read, queue); });
  // Whatever ends this function, the reader must end first.
  struct Join {
    Queue& queue;
    std::thread& reader;
    ~Join() { queue.abandon(), reader.join(); }
  } const join{queue, reader};
  while (const std::optional<Batch> batch = queue.pop())
    for (const Message& message : *batch) deliver(message, sink);
  return queue.result();
}

}  // namespace rayfield::slam
