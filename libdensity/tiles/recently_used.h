#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "rayfield/core/result.h"

namespace rayfield::density {

/// Values that can be had again at some cost, such as decoded files: the latest used are kept, as many as fit, one at
/// least. Thread-safe; several threads that want the same value wait for one of them to load it.
template <class Key, class Value>
class RecentlyUsed {
 public:
  /// `bytes`: bounds what is kept. Values that callers still hold are not counted.
  explicit RecentlyUsed(std::size_t bytes) : bytes_(bytes) {}

  /// `load` → Result<Value> where the value is not there; `bytes_of` → its size. Errors: those of `load`.
  template <class Load, class BytesOf>
  Result<std::shared_ptr<const Value>> get(const Key& key, Load&& load, BytesOf&& bytes_of) {
    const std::shared_ptr<Slot> slot = slot_of(key);
    const std::lock_guard loading(slot->mutex);
    if (slot->value) return slot->value;
    Result<Value> value = load();
    if (!value) return tl::make_unexpected(std::move(value).error());
    slot->value = std::make_shared<const Value>(std::move(*value));
    keep(key, slot, bytes_of(*slot->value));
    return slot->value;
  }

 private:
  struct Slot {
    std::mutex mutex;
    std::shared_ptr<const Value> value;
    std::size_t bytes = 0;
  };
  using Order = std::list<std::pair<Key, std::shared_ptr<Slot>>>;

  std::shared_ptr<Slot> slot_of(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(key);
    if (found == places_.end()) {
      order_.emplace_front(key, std::make_shared<Slot>());
      places_[key] = order_.begin();
    } else {
      order_.splice(order_.begin(), order_, found->second);
    }
    return order_.front().second;
  }

  void keep(const Key& key, const std::shared_ptr<Slot>& slot, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(key);
    if (found == places_.end() || found->second->second != slot) return;  // pushed out while it was loaded
    slot->bytes = bytes;
    used_ += bytes;
    while (used_ > bytes_ && order_.size() > 1) {
      used_ -= order_.back().second->bytes;
      places_.erase(order_.back().first);
      order_.pop_back();
    }
  }

  std::size_t bytes_, used_ = 0;
  std::mutex mutex_;  // of what follows
  Order order_;       // the latest first
  std::map<Key, typename Order::iterator> places_;
};

}  // namespace rayfield::density
