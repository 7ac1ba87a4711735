#include "rayfield/formats/chart.h"

#include "formats/chart/scatter_drawing.h"
#include "formats/chart/season_drawing.h"
#include "formats/chart/series_drawing.h"
#include "formats/io/guard.h"
#include "formats/picture/picture_elements.h"

namespace rayfield::formats {

using elements::kPictureWhat;

Result<void> write_scatter_chart(const DateComparison& comparison, const std::string& path,
                                 const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_scatter(comparison, path, options);
  });
}

Result<void> write_season_chart(const BlockProducts& block, std::span<const SeasonValue> values,
                                std::span<const int> rows, const std::string& path, const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_season(block, values, rows, path, options);
  });
}

Result<void> write_series_chart(const SeriesChart& chart, const std::string& path, const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_series(chart, path, options);
  });
}

}  // namespace rayfield::formats
