#include "formats/vehicle/bzip2_text.h"

#include <bzlib.h>

#include <algorithm>
#include <memory>

namespace rayfield::formats {
namespace {

constexpr std::size_t kMostGrowth = 64, kPiece = std::size_t{1} << 20;

tl::unexpected<Error> bad(std::string_view why) {
  return fail(ErrorCode::bad_input, "cannot unpack text", {}, why, "check where the file comes from");
}

// bzip2's interface predates const; it does not write to its input.
char* input(std::string_view text) { return const_cast<char*>(text.data()); }

}  // namespace

Result<std::string> pack_text(std::string_view text) {
  std::string out(text.size() + text.size() / 100 + 601, '\0');  // the bound that the bzip2 manual gives
  auto length = static_cast<unsigned>(out.size());
  const int status =
      BZ2_bzBuffToBuffCompress(out.data(), &length, input(text), static_cast<unsigned>(text.size()), 9, 0, 30);
  if (status != BZ_OK || text.size() > UINT32_MAX / 2)
    return fail(ErrorCode::internal, "cannot pack text", {}, "bzip2 refused");
  out.resize(length);
  return out;
}

bool is_packed(std::string_view bytes) { return bytes.starts_with("BZh"); }

Result<std::string> unpack_text(std::string_view bytes) {
  bz_stream stream = {};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK)
    return fail(ErrorCode::resources, "cannot unpack text", {}, "bzip2 does not start");
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> guard(&stream, BZ2_bzDecompressEnd);
  stream.next_in = input(bytes);
  stream.avail_in = static_cast<unsigned>(bytes.size());
  const std::size_t limit = bytes.size() * kMostGrowth + kPiece;
  std::string out;
  for (std::size_t done = 0;;) {
    if (done == out.size()) out.resize(std::min(out.size() + kPiece, limit));
    if (done == out.size()) return bad("it unpacks to far more than a text of numbers would");
    stream.next_out = out.data() + done;
    stream.avail_out = static_cast<unsigned>(out.size() - done);
    const unsigned room = stream.avail_out;
    const int status = BZ2_bzDecompress(&stream);
    done += room - stream.avail_out;
    if (status == BZ_STREAM_END) {
      out.resize(done);
      return out;
    }
    if (status != BZ_OK) return bad("the bzip2 data is damaged");
    if (stream.avail_in == 0 && stream.avail_out > 0) return bad("the bzip2 data ends early");
  }
}

}  // namespace rayfield::formats
