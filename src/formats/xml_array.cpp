// Compresses arrays as vtkLZ4DataCompressor and vtkZLibDataCompressor do: block by block, each on its own.
#include "formats/xml_array.hpp"

#include <lz4.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>

namespace dartcast {

namespace {

// LZ4 looks no further back. Readers allocate a block at least, whatever its array's size.
constexpr std::size_t block_bytes = 65536;

using Packed = std::array<char, LZ4_COMPRESSBOUND(block_bytes)>;  // zlib's bound is less

std::size_t pack(std::string_view block, Compression compression, Packed& out) {
  if (compression == Compression::fast) {
    return static_cast<std::size_t>(
        LZ4_compress_default(block.data(), out.data(), static_cast<int>(block.size()), static_cast<int>(out.size())));
  }
  uLongf size = out.size();
  if (::compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(block.data()),
                  block.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw std::bad_alloc();  // the only way to fail if the bound is kept
  return size;
}

void append(std::string& to, std::uint64_t number) { to.append(reinterpret_cast<const char*>(&number), sizeof number); }

XmlBlock make_block(std::string_view bytes, Compression compression) {
  XmlBlock block;
  if (compression == Compression::none) {
    append(block.head, bytes.size());
    return block;
  }
  append(block.head, (bytes.size() + block_bytes - 1) / block_bytes);
  append(block.head, block_bytes);
  append(block.head, bytes.size() % block_bytes);  // 0: the last one is full
  const auto packed = std::make_unique<Packed>();
  for (std::size_t at = 0; at < bytes.size(); at += block_bytes) {
    const std::size_t size = pack(bytes.substr(at, block_bytes), compression, *packed);
    append(block.head, size);
    block.packed.append(packed->data(), size);
  }
  return block;
}

}  // namespace

std::shared_ptr<const XmlBlock> XmlArray::block(Compression compression) const {
  if (kept_ && *kept_) return *kept_;
  auto made = std::make_shared<const XmlBlock>(make_block(bytes_, compression));
  if (kept_) *kept_ = made;
  return made;
}

}  // namespace dartcast
