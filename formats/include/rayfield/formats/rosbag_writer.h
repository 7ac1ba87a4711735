#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "rayfield/core/result.h"

namespace rayfield::formats {

enum class BagCompression { none, bz2, lz4 };

struct BagWriteOptions {
  BagCompression compression = BagCompression::none;
  /// A chunk is closed once its messages reach this size. Larger chunks compress better and lose more when the file
  /// is damaged. 4096 … 67108864.
  std::size_t chunk_bytes = std::size_t{768} << 10;
  Result<void> validate() const;
};

/// Writes ROS 1 bags v2.0 with index, as the ROS tools read them. Equal calls give equal bytes. The file appears
/// under its name only after close(); a writer destroyed before leaves nothing behind.
class BagWriter {
 public:
  /// Errors: usage (options), resources or bad_input (the system's).
  static Result<BagWriter> create(const std::string& path, const BagWriteOptions& options = {});
  BagWriter(BagWriter&&) noexcept;
  BagWriter& operator=(BagWriter&&) noexcept;
  ~BagWriter();

  /// Declares a topic and returns its connection number. `definition` is the full text whose `md5sum` is given.
  std::uint32_t add_connection(const std::string& topic, const std::string& type, const std::string& md5sum,
                               const std::string& definition);
  /// Appends a serialised message. `record_time_ns` is Unix time; 0 ≤ time < 2^32 s.
  Result<void> write(std::uint32_t connection, std::int64_t record_time_ns, std::span<const std::byte> data);
  /// Writes the index, syncs and renames. Nothing can be written afterwards.
  Result<void> close();

 private:
  struct Impl;
  explicit BagWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
