#include "formats/ray_cloud/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read ray cloud";
constexpr std::size_t kMaxProperties = 256;

struct NamedType {
  std::string_view name;
  NumberType type;
};
constexpr std::array<NamedType, 16> kTypes = {{{"char", NumberType::i8},
                                               {"int8", NumberType::i8},
                                               {"uchar", NumberType::u8},
                                               {"uint8", NumberType::u8},
                                               {"short", NumberType::i16},
                                               {"int16", NumberType::i16},
                                               {"ushort", NumberType::u16},
                                               {"uint16", NumberType::u16},
                                               {"int", NumberType::i32},
                                               {"int32", NumberType::i32},
                                               {"uint", NumberType::u32},
                                               {"uint32", NumberType::u32},
                                               {"float", NumberType::f32},
                                               {"float32", NumberType::f32},
                                               {"double", NumberType::f64},
                                               {"float64", NumberType::f64}}};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

tl::unexpected<Error> bad_line(std::size_t number, std::string_view why, std::string_view next = {}) {
  return fail(ErrorCode::bad_input, kWhat, "header line " + std::to_string(number), why, next);
}

std::string quoted(std::string_view text) { return fmt::format("'{}'", text.substr(0, 40)); }

/// State of the header's grammar while its lines go by.
struct HeaderParser {
  enum class Element { none, vertex, other };
  PlyHeader header;
  Element element = Element::none;
  bool has_format = false, has_vertex = false;

  Result<void> format(const std::vector<std::string_view>& words, std::size_t number) {
    if (words.size() != 3) return bad_line(number, "the format line is malformed");
    if (words[1] == "ascii") {
      return bad_line(number, "ASCII PLY is not supported", "write it as binary_little_endian");
    }
    if (words[1] == "binary_big_endian") {
      return bad_line(number, "big-endian PLY is not supported", "write it as binary_little_endian");
    }
    if (words[1] != "binary_little_endian" || words[2] != "1.0") return bad_line(number, "unknown PLY format");
    has_format = true;
    return {};
  }

  Result<void> begin_element(const std::vector<std::string_view>& words, std::size_t number) {
    std::uint64_t count = 0;
    const auto parsed = words.size() == 3 ? std::from_chars(words[2].data(), words[2].data() + words[2].size(), count)
                                          : std::from_chars_result{nullptr, std::errc::invalid_argument};
    if (parsed.ec != std::errc() || parsed.ptr != words[2].data() + words[2].size()) {
      return bad_line(number, "an element needs a name and a count");
    }
    if (words[1] == "vertex") {
      if (has_vertex) return bad_line(number, "a second element vertex");
      has_vertex = true;
      element = Element::vertex;
      header.vertex_count = count;
      return {};
    }
    if (count > 0 && !has_vertex) return bad_line(number, "an element stands before the vertices");
    if (count > 0) header.more_elements = true;
    element = Element::other;
    return {};
  }

  Result<void> property(const std::vector<std::string_view>& words, std::size_t number) {
    if (element == Element::none) return bad_line(number, "a property before any element");
    if (element == Element::other) return {};
    if (words.size() >= 2 && words[1] == "list") return bad_line(number, "vertices with lists are not supported");
    if (words.size() != 3) return bad_line(number, "a property needs a type and a name");
    const auto type =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const NamedType& t) { return t.name == words[1]; });
    if (type == kTypes.end()) return bad_line(number, "unknown type " + quoted(words[1]));
    if (header.find(words[2]) != nullptr) return bad_line(number, "a second property " + quoted(words[2]));
    if (header.properties.size() >= kMaxProperties) return bad_line(number, "too many properties");
    header.properties.push_back({std::string(words[2]), type->type, header.row_bytes});
    header.row_bytes += number_bytes(type->type);
    return {};
  }

  Result<void> line(std::string_view text, std::size_t number) {
    const std::vector<std::string_view> words = words_of(text);
    if (words.empty() || words[0] == "obj_info") return {};
    if (words[0] == "comment") {
      text.remove_prefix(static_cast<std::size_t>(words[0].data() + words[0].size() - text.data()));
      const std::size_t begin = text.find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) return {};
      header.comments.emplace_back(text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin));
      return {};
    }
    if (words[0] == "format") return format(words, number);
    if (words[0] == "element") return begin_element(words, number);
    if (words[0] == "property") return property(words, number);
    return bad_line(number, "unknown word " + quoted(words[0]));
  }
};

}  // namespace

const PlyProperty* PlyHeader::find(std::string_view name) const {
  for (const PlyProperty& property : properties) {
    if (property.name == name) return &property;
  }
  return nullptr;
}

Result<PlyHeader> parse_ply_header(std::string_view bytes) {
  HeaderParser parser;
  std::size_t number = 0, at = 0;
  while (at < bytes.size()) {
    const std::size_t newline = bytes.find('\n', at);
    if (newline == std::string_view::npos) break;
    std::string_view text = bytes.substr(at, newline - at);
    if (text.ends_with('\r')) text.remove_suffix(1);
    at = newline + 1;
    ++number;
    if (number == 1) {
      if (words_of(text) != std::vector<std::string_view>{"ply"}) break;
      continue;
    }
    if (words_of(text) == std::vector<std::string_view>{"end_header"}) {
      if (!parser.has_format) return bad_line(number, "the format line is missing");
      if (!parser.has_vertex) return bad_line(number, "there is no element vertex");
      parser.header.header_bytes = at;
      return std::move(parser.header);
    }
    RAYFIELD_CHECK(parser.line(text, number));
  }
  if (number <= 1) {
    return fail(ErrorCode::bad_input, kWhat, {}, "not a PLY file: it does not begin with 'ply'",
                "give a ray cloud in PLY format");
  }
  return bad_line(number, "the header has no end_header");
}

/// Coordinates and start vectors may be float or double and stand anywhere in the row, but each three next to each
/// other.
Result<RayColumns> find_ray_columns(const PlyHeader& header) {
  const auto bad = [](const std::string& why, std::string_view next = {}) {
    return fail(ErrorCode::bad_input, kWhat, "header", why, next);
  };
  // Three neighbouring columns of one floating type; nothing where they are not like that.
  const auto triple = [&](const char* first, const char* second, const char* third) -> const PlyProperty* {
    const PlyProperty* a = header.find(first);
    const PlyProperty* b = header.find(second);
    const PlyProperty* c = header.find(third);
    if (a == nullptr || b == nullptr || c == nullptr || a->type != b->type || b->type != c->type) return nullptr;
    if (a->type != NumberType::f32 && a->type != NumberType::f64) return nullptr;
    const std::size_t bytes = number_bytes(a->type);
    return b->offset == a->offset + bytes && c->offset == b->offset + bytes ? a : nullptr;
  };
  const PlyProperty* position = triple("x", "y", "z");
  if (position == nullptr) return bad("the vertices have no coordinates x y z of type float or double");
  const PlyProperty* start = triple("nx", "ny", "nz");
  if (start == nullptr) start = triple("rayx", "rayy", "rayz");  // the name in raycloudtools built without normals
  if (start == nullptr) {
    return bad("a point cloud without ray starts (no nx ny nz): where the sensor stood is not in it",
               "give the ray cloud, or join the points with their trajectory by raycloudtools' rayimport");
  }
  const PlyProperty* time = header.find("time");
  if (time == nullptr || (time->type != NumberType::f32 && time->type != NumberType::f64)) {
    return bad("the rays have no time (property double time)", "export the cloud with its times");
  }
  RayColumns columns;
  columns.position = position->offset, columns.position_double = position->type == NumberType::f64;
  columns.start = start->offset, columns.start_double = start->type == NumberType::f64;
  columns.time = time->offset, columns.time_double = time->type == NumberType::f64;
  if (const PlyProperty* alpha = header.find("alpha"); alpha != nullptr) {
    if (alpha->type != NumberType::u8) return bad("alpha is not of type uchar");
    columns.alpha = alpha->offset;
  }
  return columns;
}

}  // namespace rayfield::formats
