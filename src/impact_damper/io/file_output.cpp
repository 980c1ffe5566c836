#include "impact_damper/io/file_output.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;

// Path of the temporary file, which a signal handler may read at any time; empty: no file is being written.
std::array<char, PATH_MAX> unfinished{};

[[noreturn]] void reject(const fs::path& file, const std::string& why) {
  throw IoError(file.string() + ": cannot be written: " + why);
}

// Closes a C stream. C streams are used because they report through errno why a write failed.
struct Close {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using Stream = std::unique_ptr<std::FILE, Close>;

using Produce = std::function<void(const AddText&)>;

void write_directly(const fs::path& place, const char* mode, const fs::path& named, const Produce& produce) {
  Stream stream(std::fopen(place.c_str(), mode));
  if (!stream) reject(named, std::strerror(errno));
  produce([&](std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stream.get()) != text.size())
      reject(named, std::strerror(errno));
  });
  if (std::fflush(stream.get()) != 0) reject(named, std::strerror(errno));
  // Some file systems report a failed write only here.
  if (std::fclose(stream.release()) != 0) reject(named, std::strerror(errno));
}

bool holds(const fs::path& file, std::string_view text) {
  std::error_code error;
  if (fs::file_size(file, error) != text.size() || error) return false;
  const Stream stream(std::fopen(file.c_str(), "rb"));
  std::array<char, 65536> piece;
  while (stream && !text.empty()) {
    const std::size_t length = std::fread(piece.data(), 1, piece.size(), stream.get());
    if (length == 0 || text.substr(0, length) != std::string_view(piece.data(), length)) return false;
    text.remove_prefix(length);
  }
  return stream != nullptr;
}

// .NAME.PROCESS.tmp
std::string head_of_temporary(const fs::path& place) { return '.' + place.filename().string() + '.'; }
constexpr std::string_view tail_of_temporary = ".tmp";

// Removes temporary files of this file that killed processes have left.
void remove_abandoned(const fs::path& place) {
  const std::string head = head_of_temporary(place);
  std::error_code ignored;
  for (fs::directory_iterator entry(place.parent_path(), ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(head) || !name.ends_with(tail_of_temporary)) continue;
    const char* const first = name.data() + head.size();
    const char* const last = name.data() + name.size() - tail_of_temporary.size();
    pid_t process = 0;
    if (first >= last || std::from_chars(first, last, process).ptr != last || process <= 0) continue;
    if (::kill(process, 0) == 0 || errno != ESRCH) continue;
    std::error_code kept;
    fs::remove(entry->path(), kept);
  }
}

}  // namespace

void require_writable(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status)) reject(file, "is a directory");
  fs::path folder = file.parent_path();
  if (folder.empty()) folder = ".";
  const fs::path& place = fs::exists(status) ? file : folder;
  if (::access(place.c_str(), W_OK) != 0) reject(file, std::strerror(errno));
  if (!fs::exists(status) && !fs::is_directory(folder)) reject(file, std::strerror(ENOTDIR));
}

bool write_file(const fs::path& file, std::string_view text) {
  std::error_code none;
  require_writable(file);
  if (fs::is_regular_file(file, none) && ::access(file.c_str(), R_OK) == 0 && holds(file, text)) {
    remove_abandoned(fs::canonical(file, none));
    return false;
  }
  write_file_in_pieces(file, [&](const AddText& add) { add(text); });
  return true;
}

void write_file_in_pieces(const fs::path& file, const Produce& produce) {
  require_writable(file);
  const fs::file_status status = fs::status(file);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    write_directly(file, "wb", file, produce);
  } else {
    write_file_by(file, [&](const fs::path& temporary) { write_directly(temporary, "wbx", file, produce); });
  }
}

void write_file_by(const fs::path& file, const std::function<void(const fs::path&)>& make) {
  std::error_code error;
  require_writable(file);
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) reject(file, "is a device or a pipe");
  const fs::path place = fs::exists(status) ? fs::canonical(file, error) : fs::absolute(file, error);
  if (error) reject(file, error.message());
  remove_abandoned(place);

  const fs::path temporary = place.parent_path() / (head_of_temporary(place) + std::to_string(::getpid()) +
                                                    std::string(tail_of_temporary));
  if (temporary.native().size() >= unfinished.size()) reject(file, std::strerror(ENAMETOOLONG));
  std::memcpy(unfinished.data(), temporary.c_str(), temporary.native().size() + 1);
  try {
    fs::remove(temporary, error);
    make(temporary);
    if (fs::exists(status)) fs::permissions(temporary, status.permissions());
    fs::rename(temporary, place);
  } catch (const fs::filesystem_error& failed) {
    remove_unfinished_file();
    reject(file, failed.code().message());
  } catch (...) {
    remove_unfinished_file();
    throw;
  }
  unfinished[0] = '\0';
}

void remove_unfinished_file() noexcept {
  if (unfinished[0] != '\0') ::unlink(unfinished.data());
  unfinished[0] = '\0';
}

void write_standard_output(std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) reject("standard output", std::strerror(errno));
}

}  // namespace impact_damper
