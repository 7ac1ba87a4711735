#include "libtile/tile_file/tile_file.h"

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>

#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/h5_write.h"
#include "rayfield/tile/whole_number.h"

namespace rayfield::tile {
namespace {

constexpr const char* kFormat = "rayfield-tile";
constexpr int kVersion = 1;
static_assert(kChunkSegments <= kMostChunkElements);

tl::unexpected<Error> damaged(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read tile", path.string(), why, "run `rayfield verify`");
}

std::string header_text(const TilePartHeader& header) {
  return nlohmann::ordered_json{{"format", kFormat},
                                {"version", kVersion},
                                {"tile", {header.index.ix, header.index.iy}},
                                {"part", header.part},
                                {"segments", header.segments},
                                {"units_per_metre", static_cast<std::int64_t>(kUnitsPerMetre)},
                                {"origin_units", {header.index.ix * header.size, header.index.iy * header.size, 0}},
                                {"tile_size_units", header.size},
                                {"tile_margin_units", header.margin},
                                {"time_unit", "us since 1970-01-01T00:00:00Z"}}
      .dump();
}

Result<TilePartHeader> parse_header(const std::string& text, const std::filesystem::path& path) {
  TilePartHeader header;
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.at("format") != kFormat) return damaged(path, "it is not a tile");
    if (json.at("version") != kVersion || json.at("units_per_metre") != static_cast<std::int64_t>(kUnitsPerMetre))
      return damaged(path, "it was written by a newer version of rayfield");
    header.index = {whole_number<std::int32_t>(json.at("tile").at(0)),
                    whole_number<std::int32_t>(json.at("tile").at(1))};
    header.part = whole_number<std::uint32_t>(json.at("part"));
    header.segments = whole_number<std::uint64_t>(json.at("segments"));
    header.size = whole_number<std::int64_t>(json.at("tile_size_units"));
    header.margin = whole_number<std::int64_t>(json.at("tile_margin_units"));
  } catch (const std::exception& e) {
    return damaged(path, std::string("its attributes are not what they should be: ") + e.what());
  }
  return header;
}

}  // namespace

Result<std::vector<std::byte>> build_tile_part(const TilePartHeader& header, const std::vector<EncodedChunk>& chunks) {
  std::vector<ImageColumn> columns(kColumnCount);
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    columns[k].name = kTileColumns[k].name;
    columns[k].type = kTileColumns[k].type;
    columns[k].count = header.segments;
    columns[k].chunk_elements = chunks.empty() ? 1 : chunks.front().chunk_elements;
  }
  for (const EncodedChunk& chunk : chunks) {
    const EncodedColumns encoded = chunk.columns();
    for (std::size_t k = 0; k < kColumnCount; ++k) columns[k].chunks.push_back(encoded[k]);
  }
  return build_image(header_text(header), columns);
}

Result<TilePart> read_tile_part(const std::filesystem::path& path) {
  RAYFIELD_ASSIGN(const ImageLayout layout, read_layout(path));
  TilePart part;
  part.path = path;
  RAYFIELD_ASSIGN(part.header, parse_header(layout.attributes, path));
  std::array<const ColumnLayout*, kColumnCount> columns{};
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    columns[k] = layout.find(kTileColumns[k].name);
    if (columns[k] == nullptr || columns[k]->type != kTileColumns[k].type ||
        columns[k]->count != part.header.segments || columns[k]->chunk_elements > kChunkSegments ||
        columns[k]->chunk_elements != columns[0]->chunk_elements)
      return damaged(path, std::string("column '") + kTileColumns[k].name + "' is missing or does not fit the others");
  }
  const std::uint64_t elements = columns[0]->chunk_elements;
  for (std::size_t c = 0; c < columns[0]->chunks.size(); ++c) {
    ChunkLayout chunk;
    chunk.chunk_elements = static_cast<std::uint32_t>(elements);
    chunk.count = static_cast<std::uint32_t>(std::min(elements, part.header.segments - c * elements));
    for (std::size_t k = 0; k < kColumnCount; ++k) chunk.columns[k] = columns[k]->chunks[c];
    part.chunks.push_back(chunk);
  }
  return part;
}

}  // namespace rayfield::tile
