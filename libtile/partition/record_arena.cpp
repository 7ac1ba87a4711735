#include "libtile/partition/record_arena.h"

#include <sys/mman.h>

#include <cerrno>
#include <utility>

namespace rayfield::tile {
namespace {
constexpr std::size_t kBlockBytes = RecordArena::kBlockRecords * sizeof(RayRecord);
}

Result<RecordArena> RecordArena::create(std::size_t bytes) {
  const std::size_t blocks = bytes / kBlockBytes;
  void* memory =
      ::mmap(nullptr, blocks * kBlockBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) return fail_errno(errno, "cannot tile the scan", "buffers", "give a smaller --memory");
  return RecordArena(static_cast<RayRecord*>(memory), blocks);
}

RecordArena::RecordArena(RecordArena&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      block_count_(other.block_count_),
      returned_(std::move(other.returned_)),
      never_used_(other.never_used_) {}

RecordArena::~RecordArena() {
  if (memory_ != nullptr) ::munmap(memory_, block_count_ * kBlockBytes);
}

std::size_t RecordArena::free_blocks() const {
  const std::lock_guard lock(mutex_);
  return returned_.size() + (block_count_ - never_used_);
}

RecordArena::Block RecordArena::take() {
  const std::lock_guard lock(mutex_);
  if (returned_.empty()) return never_used_++;
  const Block block = returned_.back();
  returned_.pop_back();
  return block;
}

void RecordArena::give_back(std::span<const Block> blocks) {
  const std::lock_guard lock(mutex_);
  returned_.insert(returned_.end(), blocks.begin(), blocks.end());
}

}  // namespace rayfield::tile
