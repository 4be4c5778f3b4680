// What zlib and LZ4 do for readers natively. Blocks of zlib are unpacked by Boost; nothing is packed, and no .gz file is read.
#include <lz4.h>
#include <zlib.h>

#include <boost/beast/zlib/inflate_stream.hpp>
#include <cstddef>
#include <cstdint>

namespace {

// The sum at the end of zlib's format.
std::uint32_t adler32_of(const Bytef* bytes, std::size_t size) {
  std::uint32_t a = 1, b = 0;
  for (std::size_t i = 0; i < size; ++i) {
    a = (a + bytes[i]) % 65521U;
    b = (b + a) % 65521U;
  }
  return (b << 16U) | a;
}

}  // namespace

extern "C" {

int uncompress(Bytef* out, uLongf* out_size, const Bytef* packed, uLong size) {
  constexpr uLong head = 2, tail = 4;  // without a dictionary
  if (size < head + tail || (packed[0] & 15U) != 8 || (packed[0] * 256U + packed[1]) % 31 != 0 ||
      (packed[1] & 32U) != 0)
    return Z_DATA_ERROR;
  boost::beast::zlib::z_params z;
  z.next_in = packed + head;
  z.avail_in = size - head;  // Boost looks ahead, over the sum
  z.next_out = out;
  z.avail_out = *out_size;
  boost::beast::zlib::inflate_stream inflate;
  boost::beast::error_code error;
  inflate.write(z, boost::beast::zlib::Flush::finish, error);
  const Bytef* sum = packed + (size - tail);
  const std::uint32_t wanted = (std::uint32_t{sum[0]} << 24U) | (std::uint32_t{sum[1]} << 16U) |
                               (std::uint32_t{sum[2]} << 8U) | std::uint32_t{sum[3]};
  *out_size = z.total_out;
  const bool ended = error == boost::beast::zlib::error::end_of_stream;
  return ended && wanted == adler32_of(out, z.total_out) ? Z_OK : Z_DATA_ERROR;
}
int compress2(Bytef* /*out*/, uLongf* /*out_size*/, const Bytef* /*bytes*/, uLong /*size*/, int /*level*/) {
  return Z_MEM_ERROR;
}

gzFile gzopen(const char* /*path*/, const char* /*mode*/) { return nullptr; }
int gzread(gzFile /*file*/, voidp /*out*/, unsigned /*size*/) { return -1; }
int gzclose(gzFile /*file*/) { return Z_STREAM_ERROR; }
const char* gzerror(gzFile /*file*/, int* error) {
  *error = Z_STREAM_ERROR;
  return "";
}

int LZ4_decompress_safe(const char* /*packed*/, char* /*out*/, int /*size*/, int /*out_size*/) { return -1; }
int LZ4_compress_default(const char* /*bytes*/, char* /*out*/, int /*size*/, int /*out_size*/) { return 0; }
}
