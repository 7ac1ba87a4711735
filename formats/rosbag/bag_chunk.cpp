#include "formats/rosbag/bag_chunk.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace rayfield::formats {
namespace {

constexpr std::size_t kFirstOutput = std::size_t{4} << 20;

/// Room for more output: doubles up to `size`; false once `size` is reached.
bool grow(std::vector<std::byte>& out, std::size_t size) {
  if (out.size() >= size) return false;
  out.resize(std::min(size, std::max(kFirstOutput, out.size() * 2)));
  return true;
}

tl::unexpected<Error> bad_chunk(std::string_view why) {
  return fail(ErrorCode::bad_input, "cannot decompress chunk", {}, why);
}

Result<void> decompress_bz2(std::span<const std::byte> data, std::size_t size, std::vector<std::byte>& out) {
  bz_stream stream = {};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return fail(ErrorCode::resources, "cannot start bzip2", {}, {});
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> guard(&stream, BZ2_bzDecompressEnd);
  // bzip2's interface predates const; it does not write to its input.
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(data.data()));
  stream.avail_in = static_cast<unsigned>(data.size());
  std::size_t done = 0;
  for (;;) {
    if (done == out.size()) grow(out, size);
    // One spare byte shows whether the stream goes on after `size` bytes.
    std::byte spare{};
    const bool full = done == size;
    stream.next_out = reinterpret_cast<char*>(full ? &spare : out.data() + done);
    stream.avail_out = full ? 1U : static_cast<unsigned>(out.size() - done);
    const unsigned room = stream.avail_out;
    const int status = BZ2_bzDecompress(&stream);
    const std::size_t produced = room - stream.avail_out;
    if (full && produced > 0) return bad_chunk("it is longer than its header says");
    done += produced;
    if (status == BZ_STREAM_END) break;
    if (status == BZ_MEM_ERROR) return fail(ErrorCode::resources, "cannot decompress chunk", {}, "out of memory");
    if (status != BZ_OK) return bad_chunk("bzip2 data is damaged");
    if (stream.avail_in == 0 && produced == 0) return bad_chunk("bzip2 data ends early");
  }
  if (done != size) return bad_chunk("it is shorter than its header says");
  return {};
}

Result<void> decompress_lz4(std::span<const std::byte> data, std::size_t size, std::vector<std::byte>& out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    return fail(ErrorCode::resources, "cannot start lz4", {}, {});
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> guard(context, LZ4F_freeDecompressionContext);
  std::size_t done = 0, consumed = 0, status = 1;
  while (status != 0) {
    if (done == out.size()) grow(out, size);
    std::byte spare{};
    const bool full = done == size;
    std::size_t produced = full ? 1 : out.size() - done;
    std::size_t used = data.size() - consumed;
    status =
        LZ4F_decompress(context, full ? &spare : out.data() + done, &produced, data.data() + consumed, &used, nullptr);
    if (LZ4F_isError(status) != 0) return bad_chunk("lz4 data is damaged");
    if (full && produced > 0) return bad_chunk("it is longer than its header says");
    done += produced;
    consumed += used;
    if (status != 0 && produced == 0 && used == 0) return bad_chunk("lz4 data ends early");
  }
  if (done != size) return bad_chunk("it is shorter than its header says");
  return {};
}

}  // namespace

Result<void> decompress_bag_chunk(std::string_view compression, std::span<const std::byte> data, std::size_t size,
                                  std::vector<std::byte>& out) {
  if (data.size() > std::numeric_limits<unsigned>::max()) return bad_chunk("it is larger than 4 GiB");
  out.resize(std::min(size, std::max(out.capacity(), kFirstOutput)));
  if (compression == "bz2") RAYFIELD_CHECK(decompress_bz2(data, size, out));
  if (compression == "lz4") RAYFIELD_CHECK(decompress_lz4(data, size, out));
  return {};
}

std::string_view bag_compression_name(BagCompression compression) {
  switch (compression) {
    case BagCompression::bz2:
      return "bz2";
    case BagCompression::lz4:
      return "lz4";
    case BagCompression::none:
      break;
  }
  return "none";
}

Result<void> compress_bag_chunk(BagCompression compression, std::span<const std::byte> data,
                                std::vector<std::byte>& out) {
  if (compression == BagCompression::none) {
    out.assign(data.begin(), data.end());
    return {};
  }
  if (compression == BagCompression::bz2) {
    out.resize(data.size() + data.size() / 100 + 601);  // the bound that the bzip2 manual gives
    auto length = static_cast<unsigned>(out.size());
    char* source = const_cast<char*>(reinterpret_cast<const char*>(data.data()));
    const int status = BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &length, source,
                                                static_cast<unsigned>(data.size()), 9, 0, 30);
    if (status != BZ_OK) return fail(ErrorCode::internal, "cannot compress chunk", {}, "bzip2 refused");
    out.resize(length);
    return {};
  }
  // What the decoder in ROS (roslz4) takes: independent blocks, no block checksums, no content size.
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  out.resize(LZ4F_compressFrameBound(data.size(), &preferences));
  const std::size_t length = LZ4F_compressFrame(out.data(), out.size(), data.data(), data.size(), &preferences);
  if (LZ4F_isError(length) != 0) return fail(ErrorCode::internal, "cannot compress chunk", {}, "lz4 refused");
  out.resize(length);
  return {};
}

}  // namespace rayfield::formats
