// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_sequence.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "binary_ply.h"
#include "file_bytes.h"
#include "ply_header.h"
#include "text_scan.h"
#include "triangulate.h"
#include "weld.h"

namespace fcl_ccd {
namespace {

/// @brief A file that is opened for reading; opening may have failed. It does not wait
/// for the writer of a pipe.
class InputFile {
 public:
  explicit InputFile(const std::string& path)
      : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    if (file_ >= 0) close(file_);
  }

  int descriptor() const { return file_; }

  bool isRegularOfSize(std::size_t size) const {
    struct stat status {};
    return file_ >= 0 && fstat(file_, &status) == 0 && S_ISREG(status.st_mode) &&
           static_cast<std::size_t>(status.st_size) == size;
  }

  /// Whether the file has these bytes at an offset.
  bool has(std::string_view bytes, std::size_t offset) const {
    char block[1 << 16];
    while (!bytes.empty()) {
      const ssize_t size = pread(file_, block, std::min(bytes.size(), sizeof block),
                                 static_cast<off_t>(offset));
      if (size <= 0) return false;
      const auto read = static_cast<std::size_t>(size);
      if (std::string_view(block, read) != bytes.substr(0, read)) return false;
      bytes.remove_prefix(read);
      offset += read;
    }
    return true;
  }

 private:
  int file_;
};

bool isPly(const std::string& path) { return extensionOf(path) == "ply"; }

/// @brief The last bytes of a file.
std::string tailOf(const std::string& path) {
  constexpr std::streamoff kSize = 512;
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kSize));
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool endsInALine(const std::string& tail) {
  return !tail.empty() && tail.back() != '\n' && tail.back() != '\r';
}

/// "1 vertex".
std::string countedVertices(std::size_t number) {
  return std::to_string(number) + (number == 1 ? " vertex" : " vertices");
}

/// @brief Whether a file has text and tells how many vertices and faces it has.
/// @param[out] ends_with_vertices  whether the vertices are the last part of the file
bool isTextWithCounts(const std::string& path, bool& ends_with_vertices) {
  ends_with_vertices = false;
  if (!isPly(path)) return extensionOf(path) == "off";
  try {
    const std::string bytes = readRegularFile(path);
    std::string_view rest = bytes;
    const PlyHeader header = takePlyHeader(rest);
    for (const PlyElement& element : header.elements)
      if (element.count > 0) ends_with_vertices = element.isVertex();
    return header.format == PlyFormat::kAscii;
  } catch (const std::runtime_error&) {
    return false;  // another program has changed it
  }
}

/// @brief Whether faces are the first ones of others. The last one may have lost corners,
/// and with `is_cut` its last corner may have lost digits.
bool areFirstOf(const Faces& faces, const Faces& others, bool is_cut) {
  const auto cornersOf = [](const Faces& list, std::size_t face) {
    const auto endOf = [&](std::size_t i) {
      return list.ends.empty() ? 3 * (i + 1) : list.ends[i];
    };
    const std::size_t begin = face == 0 ? 0 : endOf(face - 1);
    return std::vector<int>(
        list.corners.begin() + static_cast<std::ptrdiff_t>(begin),
        list.corners.begin() + static_cast<std::ptrdiff_t>(endOf(face)));
  };
  if (faces.size() > others.size()) return false;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    std::vector<int> mine = cornersOf(faces, i);
    const std::vector<int> all = cornersOf(others, i);
    if (mine == all) continue;
    if (!is_cut || i + 1 < faces.size() || mine.size() > all.size()) return false;
    mine.pop_back();
    if (!std::equal(mine.begin(), mine.end(), all.begin())) return false;
  }
  return true;
}

/// @brief The same for free edges or points.
template <typename List>
bool areFirstOf(const List& list, const List& others, bool is_cut) {
  if (list.size() > others.size()) return false;
  const auto first_different = std::mismatch(list.begin(), list.end(), others.begin());
  const auto same = first_different.first - list.begin();
  return static_cast<std::size_t>(same) + (is_cut ? 1 : 0) >= list.size();
}

}  // namespace

MeshSequence::MeshSequence(std::vector<std::string> paths) : paths_(std::move(paths)) {
  assert(!paths_.empty());
  const std::string& path = paths_[0];
  // Another extension is refused before the file is opened.
  const std::string bytes =
      isMeshFormat(extensionOf(path))
          ? namingPlace([&] { return path; }, [&] { return readRegularFile(path); })
          : std::string();
  PolygonMesh first = parsePolygonMesh(path, bytes);
  triangles_ = triangulate(first.vertices, first.faces);
  faces_ = std::move(first.faces);
  free_ = joined_free_ = std::move(first.free);
  vertices_ = std::move(first.vertices);
  if (!isPly(path)) return;
  const auto block = findVertexBlock(bytes);
  if (!block) return;
  head_ = bytes.substr(0, block->begin);
  tail_begin_ = block->end();
  tail_ = bytes.substr(tail_begin_);
}

/// Whether the frame may be a binary PLY with the layout of the first one.
bool MeshSequence::hasFastLayout(const std::string& path) const {
  return !head_.empty() && isPly(path);
}

Vertices MeshSequence::read(std::size_t frame) const {
  assert(frame < paths_.size());
  if (frame == 0) return vertices_;
  if (auto kept = takeKept(frame)) return std::move(*kept);
  const std::string& path = paths_[frame];
  if (hasFastLayout(path)) {
    const auto vertices = namingPlace(
        [&] { return path; },
        [&]() -> std::optional<Vertices> {
          const std::string bytes = readRegularFile(path);
          const std::string_view file = bytes;
          if (file.size() != tail_begin_ + tail_.size() ||
              file.substr(0, head_.size()) != head_ || file.substr(tail_begin_) != tail_)
            return std::nullopt;
          Vertices decoded = decodeVertices(file, *findVertexBlock(file));
          requireFinite(decoded);
          return decoded;
        });
    if (vertices) return *vertices;
  }
  return readWhole(path);
}

Vertices MeshSequence::readWhole(const std::string& path) const {
  PolygonMesh mesh = readPolygonMesh(path);
  if (mesh.vertices.size() != vertices_.size())
    throw std::runtime_error(path + ": has " + countedVertices(mesh.vertices.size()) +
                             ", but " + paths_[0] + " has " +
                             std::to_string(vertices_.size()) +
                             ". All frames need the same vertices");
  if (mesh.faces != faces_)
    throw std::runtime_error(path + ": its faces differ from those of " + paths_[0] +
                             ". All frames need the same faces in the same order");
  if (mesh.free != free_)
    throw std::runtime_error(path + ": its lines or points differ from those of " +
                             paths_[0] +
                             ". All frames need the same lines and points in the same "
                             "order");
  return std::move(mesh.vertices);
}

void MeshSequence::check(std::size_t frame) const {
  const std::string& path = paths_[frame];
  if (hasFastLayout(path)) {
    const InputFile file(path);
    if (file.isRegularOfSize(tail_begin_ + tail_.size()) && file.has(head_, 0) &&
        file.has(tail_, tail_begin_))
      return;
  }
  // The frame is parsed once if there is room for it until its step.
  constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  Vertices vertices = readWhole(path);
  const std::size_t bytes = vertices.size() * sizeof vertices[0];
  const std::lock_guard<std::mutex> lock(kept_->mutex);
  if (frame == 0 || kept_->bytes + bytes > kMostBytes) return;
  if (kept_->frames.insert_or_assign(frame, std::move(vertices)).second)
    kept_->bytes += bytes;
}

std::optional<Vertices> MeshSequence::takeKept(std::size_t frame) const {
  const std::lock_guard<std::mutex> lock(kept_->mutex);
  const auto at = kept_->frames.find(frame);
  if (at == kept_->frames.end()) return std::nullopt;
  Vertices vertices = std::move(at->second);
  assert(kept_->bytes >= vertices.size() * sizeof vertices[0]);
  kept_->bytes -= vertices.size() * sizeof vertices[0];
  kept_->frames.erase(at);
  return vertices;
}

bool MeshSequence::mayBeginAFrame(std::size_t frame) const {
  const std::string& path = paths_[frame];
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode) ||
      !isMeshFormat(extensionOf(path)))
    return false;
  PolygonMesh mesh;
  std::string bytes;
  try {
    bytes = readRegularFile(path);
    mesh = parsePolygonMesh(path, bytes);
  } catch (const BadWord& error) {
    // A word that is whole stays what it is. The file may have grown since it was read.
    const std::string& word = error.word();
    return endsInALine(bytes) && bytes.size() >= word.size() &&
           bytes.compare(bytes.size() - word.size(), word.size(), word) == 0;
  } catch (const std::runtime_error&) {
    return true;  // cut anywhere
  }
  if (mesh.vertices.size() == vertices_.size() && mesh.faces == faces_ &&
      mesh.free == free_)
    return true;
  const bool is_obj = extensionOf(path) == "obj";
  const bool is_cut = endsInALine(bytes);
  // Other files tell how many vertices and faces they have, or have an end: only their
  // last number can be cut without being missed. (The last part of a strip may then have
  // a repeated corner, and be no face.)
  bool ends_with_vertices = false;
  if (!is_obj && (!is_cut || endsInALine(tailOf(paths_[0])) ||
                  !isTextWithCounts(path, ends_with_vertices) ||
                  mesh.vertices.size() != vertices_.size() ||
                  mesh.faces.size() + 1 < faces_.size() ||
                  mesh.free.edges.size() != free_.edges.size()))
    return false;
  return mesh.vertices.size() <= vertices_.size() &&
         areFirstOf(mesh.faces, faces_, is_cut) &&
         areFirstOf(mesh.free.edges, free_.edges, is_cut) &&
         areFirstOf(mesh.free.points, free_.points, is_cut);
}

bool MeshSequence::mayEndInACutNumber(std::size_t frame) const {
  const std::string& path = paths_[frame];
  const std::string tail = tailOf(path);
  if (!endsInALine(tail) || endsInALine(tailOf(paths_[0]))) return false;
  bool ends_with_vertices = false;
  if (extensionOf(path) != "obj")
    return isTextWithCounts(path, ends_with_vertices) && ends_with_vertices;
  const std::string line = tail.substr(tail.find_last_of("\n\r") + 1);
  return line.size() > 1 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t');
}

void MeshSequence::shorten(std::size_t size) {
  paths_.resize(size);
  // A frame that comes later may have this number and be another one.
  const std::lock_guard<std::mutex> lock(kept_->mutex);
  const auto first = kept_->frames.lower_bound(size);
  for (auto at = first; at != kept_->frames.end(); ++at)
    kept_->bytes -= at->second.size() * sizeof at->second[0];
  kept_->frames.erase(first, kept_->frames.end());
}

void MeshSequence::announce(std::size_t frame) const {
  const InputFile file(paths_[frame]);
  if (file.descriptor() >= 0) posix_fadvise(file.descriptor(), 0, 0, POSIX_FADV_WILLNEED);
}

void MeshSequence::join(const std::vector<int>& map) {
  joinVertices(map, triangles_);
  joinVertices(map, joined_free_);
}

}  // namespace fcl_ccd
