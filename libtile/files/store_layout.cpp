#include "libtile/files/store_layout.h"

#include <fmt/format.h>

#include <algorithm>

#include "rayfield/core/date.h"

namespace rayfield::tile::layout {
namespace {

constexpr std::size_t kNameLimit = 100;  // several of them and two digests stay below the 255 bytes of a file name
constexpr std::size_t kDigestShown = 16;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

}  // namespace

std::string rays_directory(const std::string& scan_id) { return fmt::format("{}/{}/{}", kScans, scan_id, kRays); }

std::string tile_file_name(TileIndex index, const std::string& sha256) {
  return fmt::format("{}_{}.{}.h5", index.ix, index.iy, sha256.substr(0, kDigestShown));
}

std::string attachment_directory(const std::string& scan_id) {
  return fmt::format("{}/{}/{}", kScans, scan_id, kAttachments);
}

std::string attachment_file_name(const std::string& name, const std::string& sha256) {
  const std::size_t dot = std::min(name.find('.'), name.size());
  return fmt::format("{}.{}{}", name.substr(0, dot), sha256.substr(0, kDigestShown), name.substr(dot));
}

std::string derived_directory(const std::string& scan_id, const std::string& kind) {
  if (scan_id.empty()) return fmt::format("{}/{}", kRegistry, kind);
  return fmt::format("{}/{}/{}", kScans, scan_id, kind);
}

std::string derived_prefix(const std::string& name, const std::string& key) {
  return fmt::format("{}.{}.", name, key.substr(0, kDigestShown));
}

std::string derived_file_name(const std::string& name, const std::string& key, const std::string& sha256) {
  return derived_prefix(name, key) + sha256.substr(0, kDigestShown) + ".h5";
}

std::string snapshot_file_name(std::uint64_t number) { return fmt::format("{:08}.json", number); }

Result<std::string> scan_id(const std::string& date, const std::string& name) {
  RAYFIELD_ASSIGN(std::string id, parse_date(date));
  if (name.empty()) return id;
  std::string label = name;
  std::replace_if(
      label.begin(), label.end(), [](char c) { return !is_plain(c); }, '-');
  if (label.size() > kNameLimit)
    return fail(ErrorCode::usage, "cannot name the scan", name.substr(0, 40) + "...",
                fmt::format("the name is longer than {} characters", kNameLimit), "give a shorter --name");
  if (label.find_first_not_of("-.") == std::string::npos)
    return fail(ErrorCode::usage, "cannot name the scan", name, "the name has no letter or digit",
                "give another --name");
  return id + "_" + label;
}

bool is_plain_name(std::string_view text) {
  return !text.empty() && text.size() <= kNameLimit + 32 && text.front() != '.' &&
         std::all_of(text.begin(), text.end(), is_plain);
}

bool is_inside(const std::string& path) {
  const std::filesystem::path parsed(path);
  if (path.empty() || parsed.is_absolute() || path.find('\0') != std::string::npos) return false;
  return std::none_of(parsed.begin(), parsed.end(), [](const auto& part) { return part == ".." || part == "."; });
}

}  // namespace rayfield::tile::layout
