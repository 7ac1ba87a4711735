#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"

namespace rayfield::formats {

inline constexpr const char* kRigWhat = "cannot use rig file";
inline constexpr double kRigUnitTolerance = 1e-3;  // of quaternions and axes

/// One table of a rig file. Keys are taken by name; finish() refuses those that nobody took. The first error stays.
class RigSection {
 public:
  RigSection(const toml::table* table, std::string name, std::string file)
      : table_(table), name_(std::move(name)), file_(std::move(file)) {}

  bool present() const { return table_ != nullptr; }
  /// A table inside this one; not present() where the file does not have it.
  RigSection section(std::string_view key) {
    const toml::node* node = take(key);
    if (node != nullptr && !node->is_table()) refuse(*node, key, "must be a table");
    return RigSection(node == nullptr ? nullptr : node->as_table(), std::string(key), file_);
  }
  bool has(std::string_view key) const { return table_ != nullptr && table_->contains(key); }

  void text(std::string_view key, std::string& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<std::string> value = node->value_exact<std::string>();
      if (!value) return refuse(*node, key, "must be a string");
      if (value->empty()) return refuse(*node, key, "must not be empty");
      out = *value;
    }
  }
  void number(std::string_view key, double low, double high, double& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
      if (!value) return refuse(*node, key, "must be a number");
      if (!(*value >= low && *value <= high)) return refuse(*node, key, fmt::format("must be {} to {}", low, high));
      out = *value;
    }
  }
  /// A full angle; of two, those of an elliptical beam across each other, their geometric mean: the area of the disc
  /// counts.
  void divergence(std::string_view key, double high, double& out) {
    if (table_ == nullptr || !table_->contains(key) || !(*table_)[key].is_array()) return number(key, 0, high, out);
    const toml::node& node = *take(key);
    std::array<double, 2> angles{};
    if (!numbers(node, key, angles)) return;
    for (const double angle : angles)
      if (!(angle > 0 && angle <= high))
        return refuse(node, key, fmt::format("both must be above 0 and up to {}", high));
    out = std::sqrt(angles[0] * angles[1]);
  }
  void flag(std::string_view key, bool& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<bool> value = node->value_exact<bool>();
      if (!value) return refuse(*node, key, "must be true or false");
      out = *value;
    }
  }
  void no_return(std::string_view key, NoReturn& out) {
    if (const toml::node* node = take(key)) {
      const std::string value = node->value_exact<std::string>().value_or("");
      if (value == "inf")
        out = NoReturn::infinity;
      else if (value == "zero")
        out = NoReturn::zero;
      else if (value == "max")
        out = NoReturn::max_range;
      else
        refuse(*node, key, "must be \"inf\", \"zero\" or \"max\"");
    }
  }
  void return_mode(std::string_view key, std::optional<ReturnMode>& out) {
    if (const toml::node* node = take(key)) {
      out = return_mode_named(node->value_exact<std::string>().value_or(""));
      if (!out) refuse(*node, key, "must be \"first\", \"strongest\" or \"last\"");
    }
  }
  void direction(std::string_view key, Eigen::Vector3d& out) {
    const toml::node* node = take(key);
    std::array<double, 3> values{};
    if (node == nullptr || !numbers(*node, key, values)) return;
    const Eigen::Vector3d vector(values[0], values[1], values[2]);
    if (!(std::abs(vector.norm() - 1.0) <= kRigUnitTolerance)) return refuse(*node, key, "must be a unit vector");
    out = vector.normalized();
  }
  /// { xyz = [x, y, z], q = [x, y, z, w] }; without rotation where `q_allowed` is false.
  bool pose(std::string_view key, bool q_allowed, Rigid3& out) {
    const toml::node* node = take(key);
    if (node == nullptr) return false;
    RigSection inner(node->as_table(), name_ + "." + std::string(key), file_);
    if (!inner.present()) {
      refuse(*node, key, "must be a table { xyz = [x, y, z], q = [x, y, z, w] }");
      return true;
    }
    if (!inner.has("xyz")) refuse(*node, key, "has no xyz");
    inner.translation(out.translation);
    if (q_allowed) inner.rotation(out.rotation);
    inner.finish();
    if (!error_ && inner.error_) error_ = std::move(inner.error_);
    return true;
  }
  void missing(std::string_view key, std::string_view next) {
    if (error_) return;
    error_ = Error{ErrorCode::usage, kRigWhat, file_, fmt::format("{}.{} is missing", name_, key), std::string(next)};
  }
  void refuse_key(std::string_view key, std::string_view why) {
    if (const toml::node* node = take(key)) refuse(*node, key, why);
  }
  /// The first thing that is wrong with this table.
  Result<void> finish() {
    if (table_ != nullptr && !error_) {
      for (const auto& [key, node] : *table_) {
        if (taken_.end() == std::find(taken_.begin(), taken_.end(), key.str())) {
          refuse(node, key.str(), "unknown key");
          break;
        }
      }
    }
    if (error_) return tl::make_unexpected(*error_);
    return {};
  }

 private:
  const toml::node* take(std::string_view key) {
    taken_.emplace_back(key);
    return table_ == nullptr ? nullptr : table_->get(key);
  }
  void refuse(const toml::node& node, std::string_view key, std::string_view why) {
    if (error_) return;
    const std::string full = name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
    error_ = Error{ErrorCode::usage, kRigWhat, fmt::format("{}, line {}", file_, node.source().begin.line),
                   fmt::format("{}: {}", full, why), "see docs/rig.md"};
  }
  template <std::size_t N>
  bool numbers(const toml::node& node, std::string_view key, std::array<double, N>& out) {
    const toml::array* array = node.as_array();
    bool good = array != nullptr && array->size() == N;
    for (std::size_t i = 0; good && i < N; ++i) {
      const toml::node& element = *array->get(i);
      out[i] = element.is_number() ? element.value<double>().value_or(NAN) : static_cast<double>(NAN);
      good = std::isfinite(out[i]);
    }
    if (!good) refuse(node, key, fmt::format("must be an array of {} numbers", N));
    return good;
  }
  void translation(Eigen::Vector3d& out) {
    constexpr double kLongest_m = 100;
    const toml::node* node = take("xyz");
    std::array<double, 3> values{};
    if (node == nullptr || !numbers(*node, "xyz", values)) return;
    out = {values[0], values[1], values[2]};
    if (out.cwiseAbs().maxCoeff() > kLongest_m) refuse(*node, "xyz", "must be within 100 m");
  }
  void rotation(Eigen::Quaterniond& out) {
    const toml::node* node = take("q");
    std::array<double, 4> values{};
    if (node == nullptr || !numbers(*node, "q", values)) return;
    const Eigen::Quaterniond rotation(values[3], values[0], values[1], values[2]);
    if (!(std::abs(rotation.norm() - 1.0) <= kRigUnitTolerance)) {
      return refuse(*node, "q", fmt::format("must be a unit quaternion x y z w; its norm is {:.6g}", rotation.norm()));
    }
    out = rotation.normalized();
  }

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string> taken_;
  std::optional<Error> error_;
};

}  // namespace rayfield::formats
