#include "rayfield/formats/ply_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "formats/io/file_io.h"
#include "formats/ray_cloud/beam_comment.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot write ray cloud";
constexpr std::size_t kRowBytes = 4 * sizeof(double) + 3 * sizeof(float) + 4;
constexpr std::size_t kCountDigits = 20;  // of 2^64

/// The header for a number of rays. It is equally long for every number, so that it can be replaced at the end: a
/// comment is padded. raycloudtools looks for the words time, intensity and property in any line, comments too.
std::string header_text(std::uint64_t rays, const PlyWriteOptions& options) {
  const std::string count = std::to_string(rays);
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by rayfield";
  text.append(kCountDigits - count.size(), ' ');
  text += '\n';
  if (!options.crs.empty()) text += "comment crs " + options.crs + "\n";
  if (options.beam) text += "comment " + beam_comment(*options.beam) + "\n";
  text += "element vertex " + count + "\n";
  for (const char* name : {"x", "y", "z", "time"}) text += std::string("property double ") + name + "\n";
  for (const char* name : {"nx", "ny", "nz"}) text += std::string("property float ") + name + "\n";
  for (const char* name : {"red", "green", "blue", "alpha"}) text += std::string("property uchar ") + name + "\n";
  return text + "end_header\n";
}

template <class T>
std::byte* store(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof(T));
  return to + sizeof(T);
}

}  // namespace

Result<void> PlyWriteOptions::validate() const {
  const bool printable = std::all_of(crs.begin(), crs.end(), [](char c) { return c > ' ' && c < 0x7f; });
  const auto has = [this](const char* word) { return crs.find(word) != std::string::npos; };
  if (!printable || crs.size() > 64 || has("time") || has("intensity") || has("property")) {
    return fail(ErrorCode::usage, kWhat, "crs", "not a code like EPSG:7854");
  }
  return {};
}

struct PlyWriter::Impl {
  OutputFile file;
  PlyWriteOptions options;
  std::uint64_t rays = 0;
  std::vector<std::byte> rows;
};

PlyWriter::PlyWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PlyWriter::PlyWriter(PlyWriter&&) noexcept = default;
PlyWriter& PlyWriter::operator=(PlyWriter&&) noexcept = default;
PlyWriter::~PlyWriter() = default;

Result<PlyWriter> PlyWriter::create(const std::string& path, const PlyWriteOptions& options) {
  RAYFIELD_CHECK(options.validate());
  auto impl = std::make_unique<Impl>();
  RAYFIELD_ASSIGN(impl->file, OutputFile::create(path, kWhat));
  impl->options = options;
  RAYFIELD_CHECK(impl->file.write(header_text(0, options)));
  return PlyWriter(std::move(impl));
}

/// Rows are built in blocks, so that a large batch is not held twice.
Result<void> PlyWriter::write(const RayBatch& batch) {
  constexpr std::size_t kBlockRows = 16384;
  for (std::size_t first = 0; first < batch.size(); first += kBlockRows) {
    const std::size_t last = std::min(batch.size(), first + kBlockRows);
    impl_->rows.resize((last - first) * kRowBytes);
    std::byte* to = impl_->rows.data();
    for (std::size_t i = first; i < last; ++i) {
      const Eigen::Vector3d& end = batch.end[i];
      const Eigen::Vector3f back = (batch.origin[i] - end).cast<float>();
      if (!std::isfinite(end.sum() + static_cast<double>(back.sum()) + batch.time_s[i])) {
        return fail(ErrorCode::bad_input, kWhat, impl_->file.path() + ", ray " + std::to_string(impl_->rays + i),
                    "it has NaN or infinite values");
      }
      const int intensity = std::clamp<int>(batch.intensity[i], 1, 255);
      const auto alpha = static_cast<std::uint8_t>(batch.hit[i] != 0 ? intensity : 0);
      for (int k = 0; k < 3; ++k) to = store(to, end(k));
      to = store(to, batch.time_s[i]);
      for (int k = 0; k < 3; ++k) to = store(to, back(k));
      for (int k = 0; k < 4; ++k) to = store(to, alpha);
    }
    RAYFIELD_CHECK(impl_->file.write(impl_->rows));
  }
  impl_->rays += batch.size();
  return {};
}

Result<void> PlyWriter::close() {
  const std::string header = header_text(impl_->rays, impl_->options);
  RAYFIELD_CHECK(impl_->file.overwrite(0, std::as_bytes(std::span<const char>(header.data(), header.size()))));
  return impl_->file.commit();
}

std::uint64_t PlyWriter::ray_count() const { return impl_->rays; }

}  // namespace rayfield::formats
