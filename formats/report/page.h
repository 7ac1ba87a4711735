#pragma once

#include <map>
#include <string>
#include <string_view>

namespace rayfield::formats {

/// A template's {{name}} replaced by parts. What is put in is never looked at again, so a text that says {{name}}
/// stays one. A name without a part is a programmer's error.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& parts);

/// "sha256-…", by which a content security policy allows an inline script or style of exactly this text.
std::string csp_hash(std::string_view text);

/// JSON that can stand within <script type="application/json">: no '<', which could end the element or open a comment,
/// and no line separators that older JavaScript trips over.
std::string json_for_script(std::string json);

/// The whole document: the page's template, style and script around `parts`, which are HTML, and `data`, which is JSON.
std::string page(std::map<std::string, std::string> parts, std::string data);

}  // namespace rayfield::formats
