#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"

namespace rayfield::density {

/// A grid that may be larger than memory. It is made of square pages, which exist once a cell of theirs was asked for;
/// the latest used are in memory, the others in a temporary file. Cells are T() at first. What is asked for near the
/// last place costs no more than in a grid in memory. Errors: resources (the temporary file). For one thread.
template <class T>
class PagedGrid {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  static constexpr int kSide = 64;  ///< of a page, cells
  static constexpr std::size_t kPageBytes = sizeof(T) * kSide * kSide;

  /// `bytes`: bounds the pages in memory, of which there is one at least. `folder`: of the temporary file.
  PagedGrid(int nx, int ny, std::size_t bytes, std::filesystem::path folder)
      : nx_(nx),
        ny_(ny),
        most_pages_(std::max<std::size_t>(1, bytes / kPageBytes)),
        spill_(std::make_unique<SpillFile>(std::move(folder))) {}

  int nx() const { return nx_; }
  int ny() const { return ny_; }
  int bands() const { return (ny_ + kSide - 1) / kSide; }

  /// The cell, to be read and changed until another one is asked for.
  Result<T*> at(int ix, int iy) {
    RAYFIELD_ASSIGN(Page* const page, page_at(key_of(ix / kSide, iy / kSide)));
    page->changed = true;
    return &page->cells[static_cast<std::size_t>(iy % kSide) * kSide + static_cast<std::size_t>(ix % kSide)];
  }

  /// Calls visit(ix, iy, cell) for the cells of rows band·kSide … that are on a page, page by page.
  template <class Visit>
  Result<void> visit_band(int band, Visit&& visit) {
    for (int px = 0; px * kSide < nx_; ++px) {
      const std::uint64_t key = key_of(px, band);
      if (pages_.count(key) == 0) continue;
      RAYFIELD_ASSIGN(const Page* const page, page_at(key));
      for (int y = 0; y < std::min(kSide, ny_ - band * kSide); ++y)
        for (int x = 0; x < std::min(kSide, nx_ - px * kSide); ++x)
          visit(px * kSide + x, band * kSide + y,
                page->cells[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)]);
    }
    return {};
  }

 private:
  struct Page {
    std::vector<T> cells;  // empty: in the file only
    bool changed = false;  // since it was put there
    std::optional<SpillFile::Extent> stored;
    std::list<std::uint64_t>::iterator place;  // in order_, while in memory
  };

  static std::uint64_t key_of(int px, int py) {
    return static_cast<std::uint64_t>(py) << 32U | static_cast<std::uint64_t>(px);
  }

  Result<Page*> page_at(std::uint64_t key) {
    if (latest_ != nullptr && latest_key_ == key) return latest_;
    latest_ = nullptr;
    Page& page = pages_[key];
    if (!page.cells.empty()) {
      order_.splice(order_.begin(), order_, page.place);
    } else {
      if (order_.size() >= most_pages_) RAYFIELD_CHECK(put_aside(pages_[order_.back()]));
      page.cells.assign(std::size_t{kSide} * kSide, T());
      if (page.stored) RAYFIELD_CHECK(spill_->read(*page.stored, std::as_writable_bytes(std::span(page.cells))));
      page.place = order_.insert(order_.begin(), key);
    }
    latest_ = &page, latest_key_ = key;
    return latest_;
  }

  // The place in the file of a page that has changed is used again.
  Result<void> put_aside(Page& page) {
    const auto bytes = std::as_bytes(std::span(page.cells));
    if (page.stored && page.changed) {
      RAYFIELD_CHECK(spill_->overwrite(*page.stored, bytes));
    } else if (!page.stored) {
      RAYFIELD_ASSIGN(page.stored, spill_->append(bytes));
    }
    page.changed = false;
    page.cells = {};
    order_.pop_back();
    return {};
  }

  int nx_, ny_;
  std::size_t most_pages_;
  std::unique_ptr<SpillFile> spill_;
  std::unordered_map<std::uint64_t, Page> pages_;
  std::list<std::uint64_t> order_;  // of the pages in memory, the latest first
  Page* latest_ = nullptr;          // the first of them
  std::uint64_t latest_key_ = 0;
};

}  // namespace rayfield::density
