#include "rayfield/formats/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/io/file_io.h"
#include "formats/io/guard.h"
#include "formats/picture/color.h"
#include "formats/point_cloud/las_format.h"
#include "formats/point_cloud/ply_format.h"

namespace rayfield::formats {
namespace {

/// Of what has no density.
constexpr Rgba kUnknown{150, 150, 150, 255};
constexpr std::size_t kBlockPoints = 16384;

bool is_printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c < 0x7f; });
}

Result<void> check_options(const PointCloudOptions& options, const std::string& path) {
  const auto bad = [&](std::string_view why) { return fail(ErrorCode::usage, kPointCloudWhat, path, why); };
  if (!is_printable(options.software) || !is_printable(options.date) || options.software.size() > 32)
    return bad("software and date must be printable text in one line");
  if (!(options.scale.low < options.scale.high)) return bad("the colour scale needs low < high");
  if (!options.offset_m.allFinite()) return bad("the offset is not finite");
  return {};
}

}  // namespace

struct PointCloudWriter::Impl {
  OutputFile file;
  ColorScale scale;
  std::unique_ptr<PointFormat> format;
  std::vector<std::byte> records;
};

PointCloudWriter::PointCloudWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PointCloudWriter::PointCloudWriter(PointCloudWriter&&) noexcept = default;
PointCloudWriter& PointCloudWriter::operator=(PointCloudWriter&&) noexcept = default;
PointCloudWriter::~PointCloudWriter() = default;

Result<PointCloudWriter> PointCloudWriter::create(const std::string& path, PointCloudFormat format,
                                                  const PointCloudOptions& options) {
  return guarded(kPointCloudWhat, path, [&]() -> Result<PointCloudWriter> {
    RAYFIELD_CHECK(check_options(options, path));
    auto impl = std::make_unique<Impl>();
    impl->scale = options.scale;
    RAYFIELD_ASSIGN(impl->format,
                    format == PointCloudFormat::las ? make_las_format(options) : make_ply_format(options));
    RAYFIELD_ASSIGN(impl->file, OutputFile::create(path, kPointCloudWhat));
    RAYFIELD_CHECK(impl->file.write(impl->format->header()));
    return PointCloudWriter(std::move(impl));
  });
}

Result<void> PointCloudWriter::write(const DensityPoints& points) {
  PointFormat& format = *impl_->format;
  impl_->records.reserve(kBlockPoints * format.record_bytes());
  for (std::size_t first = 0; first < points.size(); first += kBlockPoints) {
    const std::size_t last = std::min(points.size(), first + kBlockPoints);
    impl_->records.clear();
    for (std::size_t i = first; i < last; ++i) {
      const auto density = static_cast<double>(points.density[i]);
      if (!points.position[i].allFinite())
        return fail(ErrorCode::bad_input, kPointCloudWhat, impl_->file.path(), "a point has NaN or infinite values");
      const Rgba color = std::isfinite(density) ? color_at(impl_->scale, density) : kUnknown;
      if (auto added = format.add(points, i, color, impl_->records); !added) {
        added.error().where = impl_->file.path();
        return added;
      }
    }
    RAYFIELD_CHECK(impl_->file.write(impl_->records));
  }
  return {};
}

Result<void> PointCloudWriter::close() {
  const std::string header = impl_->format->header();
  RAYFIELD_CHECK(impl_->file.overwrite(0, std::as_bytes(std::span<const char>(header.data(), header.size()))));
  return impl_->file.commit();
}

std::uint64_t PointCloudWriter::point_count() const { return impl_->format->count; }

}  // namespace rayfield::formats
