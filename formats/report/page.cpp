#include "formats/report/page.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <utility>

#include "formats/io/base64.h"
#include "page_parts.h"
#include "rayfield/core/sha256.h"

namespace rayfield::formats {
namespace {

std::byte hex_digit(char c) { return static_cast<std::byte>(c <= '9' ? c - '0' : c - 'a' + 10); }

void replace_all(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

}  // namespace

std::string fill_template(std::string_view text, const std::map<std::string, std::string>& parts) {
  std::string out;
  for (;;) {
    const std::size_t open = text.find("{{");
    const std::size_t close = open == std::string_view::npos ? open : text.find("}}", open);
    if (close == std::string_view::npos) return out.append(text);
    const auto part = parts.find(std::string(text.substr(open + 2, close - open - 2)));
    assert(part != parts.end());
    out.append(text.substr(0, open));
    if (part != parts.end()) out.append(part->second);
    text.remove_prefix(close + 2);
  }
}

std::string csp_hash(std::string_view text) {
  const std::string hex = sha256_hex(text);
  std::array<std::byte, 32> digest{};
  for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = hex_digit(hex[2 * i]) << 4U | hex_digit(hex[2 * i + 1]);
  return "sha256-" + base64(digest);
}

std::string json_for_script(std::string json) {
  replace_all(json, "<", "\\u003c");
  replace_all(json, "\xE2\x80\xA8", "\\u2028");
  replace_all(json, "\xE2\x80\xA9", "\\u2029");
  return json;
}

std::string page(std::map<std::string, std::string> parts, std::string data) {
  parts["policy"] = "default-src 'none'; script-src '" + csp_hash(kPageScript) + "'; style-src '" +
                    csp_hash(kPageStyle) + "'; base-uri 'none'; form-action 'none'";
  parts["style"] = kPageStyle;
  parts["script"] = kPageScript;
  parts["data"] = json_for_script(std::move(data));
  return fill_template(kPageTemplate, parts);
}

}  // namespace rayfield::formats
