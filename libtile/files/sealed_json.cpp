#include "libtile/files/sealed_json.h"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "libtile/files/file_io.h"
#include "rayfield/core/date.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

constexpr std::string_view kStart = "{\"sha256\": \"";
constexpr std::size_t kHexDigits = 64;
// A block of 50 scans with 10 000 tiles each has snapshots of 200 MB.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;

std::string middle(std::string_view what) { return "\",\n\"" + std::string(what) + "\": "; }

}  // namespace

std::string seal_json(std::string_view what, const nlohmann::ordered_json& body) {
  const std::string text = body.dump(1);
  return std::string(kStart) + sha256_hex(text) + middle(what) + text + "}\n";
}

Result<nlohmann::ordered_json> unseal_json(std::string_view what, std::string_view text, const std::string& where) {
  const auto damaged = [&](const std::string& why) {
    return fail(ErrorCode::damaged, "cannot read the store", where, why, "run `rayfield verify`");
  };
  const std::string between = middle(what);
  const std::size_t begin = kStart.size() + kHexDigits + between.size();
  if (text.size() < begin + 2 || text.substr(0, kStart.size()) != kStart ||
      text.substr(kStart.size() + kHexDigits, between.size()) != between || text.substr(text.size() - 2) != "}\n")
    return damaged("it is not a document of a rayfield store");
  const std::string_view body = text.substr(begin, text.size() - 2 - begin);
  if (sha256_hex(body) != text.substr(kStart.size(), kHexDigits))
    return damaged("its bytes do not agree with its SHA-256");
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(body, nullptr, false);
  if (json.is_discarded()) return damaged("it is not JSON");
  return json;
}

// The start is looked at before the rest is read: a sparse file is as large as it likes.
Result<nlohmann::ordered_json> read_sealed_json(std::string_view what, const std::filesystem::path& path) {
  constexpr std::string_view kCannotRead = "cannot read the store";
  auto opened = open_regular_file(path.string(), kCannotRead);
  if (!opened) {  // a store without it, or with a pipe in its place, is damaged
    if (opened.error().code == ErrorCode::bad_input)
      opened.error().code = ErrorCode::damaged, opened.error().next = "run `rayfield verify`";
    return tl::make_unexpected(std::move(opened).error());
  }
  const InputDescriptor& file = *opened;
  std::string text(kStart.size(), '\0');
  RAYFIELD_ASSIGN(const std::size_t got,
                  read_at(file.descriptor, 0, std::as_writable_bytes(std::span(text)), kCannotRead, path.string()));
  if (got < text.size() || text != kStart || file.size > kMostBytes)
    return fail(ErrorCode::damaged, kCannotRead, path.string(), "it is not a document of a rayfield store",
                "run `rayfield verify`");
  text.resize(static_cast<std::size_t>(file.size));
  RAYFIELD_CHECK(read_exactly(file.descriptor, 0, std::as_writable_bytes(std::span(text)), path));
  return unseal_json(what, text, path.string());
}

std::string now_utc() {
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) return utc_text(std::strtod(fixed, nullptr));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return utc_text(std::chrono::duration<double>(now).count());
}

}  // namespace rayfield::tile
