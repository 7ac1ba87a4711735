#include "libdensity/results/section_values.h"

#include <utility>

namespace rayfield::density {

Result<void> SectionValues::take(SectionProduct& section) {
  const std::vector<float> values = std::exchange(section.grid.values, {});
  if (values.empty()) return {};
  RAYFIELD_CHECK(file_->append(std::as_bytes(std::span(values))));
  return {};
}

tile::ColumnSource SectionValues::source() const {
  // Extents follow each other: the file is one list of values.
  const SpillFile* const file = file_.get();
  return {file->bytes_written() / sizeof(float), [file](std::uint64_t first, std::span<float> values) {
            const auto bytes = std::as_writable_bytes(values);
            return file->read({first * sizeof(float), bytes.size()}, bytes);
          }};
}

}  // namespace rayfield::density
