#pragma once

#include <cstdint>
#include <string_view>

namespace rayfield {

/// Long work reports its progress here and asks whether to stop. The default implementation ignores everything.
/// Calls may come from any thread.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A new stage begins: `unit` is what is counted ("rays", "tiles"); total 0 = unknown.
  virtual void stage(std::string_view /*name*/, std::uint64_t /*total*/, std::string_view /*unit*/) {}
  /// Another `count` units of the current stage are done.
  virtual void advance(std::uint64_t /*count*/) {}
  /// Something that the user should know, although the work goes on.
  virtual void warn(std::string_view /*message*/) {}
  /// True once the user asked to stop: the work returns ErrorCode::interrupted at its next safe point.
  virtual bool cancelled() const { return false; }
};

}  // namespace rayfield
