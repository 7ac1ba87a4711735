#include "libtile/files/store_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rayfield/core/date.h"

namespace rayfield::tile::layout {
namespace {

constexpr std::size_t kNameLimit = 100;  // several of them and two digests stay below the 255 bytes of a file name
constexpr std::size_t kDigestShown = 16;
constexpr std::size_t kTemporaryDigits = 32, kRandomLetters = 6;  // of create_temporary(), of mkstemp(3)

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

bool is_hex(std::string_view text) { return text.find_first_not_of("0123456789abcdef") == std::string_view::npos; }

// Parts of a name between dots.
std::vector<std::string_view> parts_of(std::string_view name) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t dot = std::min(name.find('.'), name.size());
    parts.push_back(name.substr(0, dot));
    if (dot == name.size()) return parts;
    name.remove_prefix(dot + 1);
  }
}

bool is_digest(std::string_view part) { return part.size() == kDigestShown && is_hex(part); }

// "<ix>_<iy>"
bool is_tile(std::string_view part) {
  const std::size_t middle = part.find('_');
  if (middle == std::string_view::npos) return false;
  for (std::string_view number : {part.substr(0, middle), part.substr(middle + 1)}) {
    if (number.substr(0, 1) == "-") number.remove_prefix(1);
    if (number.empty() || number.find_first_not_of("0123456789") != std::string_view::npos) return false;
  }
  return true;
}

bool is_random(std::string_view name, std::string_view prefix) {
  return name.size() == prefix.size() + kRandomLetters && name.substr(0, prefix.size()) == prefix &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(prefix.size()), name.end(), is_plain);
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
  // An empty part is the last of a path that ends in a slash, which is a folder's.
  return std::none_of(parsed.begin(), parsed.end(),
                      [](const auto& part) { return part.empty() || part == ".." || part == "."; });
}

bool is_own_file(const std::filesystem::path& directory, std::string_view name) {
  const std::string kind = directory.filename().string();
  const bool of_scan = directory.begin() != directory.end() && *directory.begin() == kScans;
  const std::vector<std::string_view> parts = parts_of(name);
  const std::size_t n = parts.size();
  if (!std::all_of(name.begin(), name.end(), is_plain)) return false;
  if (of_scan && kind == kAttachments) return n >= 2 && is_digest(parts[1]);
  if (n < 3 || parts[n - 1] != "h5" || !is_digest(parts[n - 2])) return false;
  if (of_scan && kind == kRays) return n == 3 && is_tile(parts[0]);
  return n >= 4 && parts[n - 3].size() == kDigestShown;  // of the key, which the caller makes
}

bool is_own_temporary_file(std::string_view name) {
  return (name.size() == kTemporaryDigits + 4 && is_hex(name.substr(0, kTemporaryDigits)) &&
          name.substr(kTemporaryDigits) == ".tmp") ||
         is_random(name, "rayfield-");
}

bool is_own_scratch_folder(std::string_view name) { return is_random(name, "align."); }

}  // namespace rayfield::tile::layout
