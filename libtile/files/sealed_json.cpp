#include "libtile/files/sealed_json.h"

#include <chrono>
#include <cstdlib>

#include "libtile/files/file_io.h"
#include "rayfield/core/date.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

constexpr std::string_view kStart = "{\"sha256\": \"";
constexpr std::size_t kHexDigits = 64;

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

Result<nlohmann::ordered_json> read_sealed_json(std::string_view what, const std::filesystem::path& path) {
  RAYFIELD_ASSIGN(const std::vector<std::byte> bytes, read_file(path, "cannot read the store"));
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return unseal_json(what, text, path.string());
}

std::string now_utc() {
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) return utc_text(std::strtod(fixed, nullptr));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return utc_text(std::chrono::duration<double>(now).count());
}

}  // namespace rayfield::tile
