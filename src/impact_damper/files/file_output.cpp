#include "impact_damper/files/file_output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "impact_damper/files/errors.hpp"
#include "impact_damper/files/json_reader.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw IoError(file.string() + ": cannot be written: " + why);
}

// C streams, because they report through errno why a write failed.
struct Close {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};

void write_directly(const fs::path& place, const fs::path& named, std::string_view text) {
  std::unique_ptr<std::FILE, Close> stream(std::fopen(place.c_str(), "wb"));
  if (!stream) refuse(named, std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), stream.get()) == text.size();
  if (!written || std::fflush(stream.get()) != 0) refuse(named, std::strerror(errno));
}

bool holds(const fs::path& file, std::string_view text) {
  std::error_code error;
  return fs::file_size(file, error) == text.size() && !error && read_text(file) == text;
}

}  // namespace

void require_writable(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status)) refuse(file, "is a directory");
  fs::path folder = file.parent_path();
  if (folder.empty()) folder = ".";
  const fs::path& place = fs::exists(status) ? file : folder;
  if (::access(place.c_str(), W_OK) != 0) refuse(file, std::strerror(errno));
  if (!fs::exists(status) && !fs::is_directory(folder)) refuse(file, std::strerror(ENOTDIR));
}

bool write_file(const fs::path& file, std::string_view text) {
  std::error_code error;
  fs::path place = file;
  require_writable(file);
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) {
      write_directly(file, file, text);
      return true;
    }
    place = fs::canonical(file, error);
    if (error) refuse(file, error.message());
    if (::access(place.c_str(), R_OK) == 0 && holds(place, text)) return false;
  }

  fs::path temporary = place;
  temporary.replace_filename('.' + place.filename().string() + '.' + std::to_string(::getpid()) + ".tmp");
  try {
    write_directly(temporary, file, text);
    if (fs::exists(status)) fs::permissions(temporary, status.permissions());
    fs::rename(temporary, place);
  } catch (const fs::filesystem_error& failed) {
    fs::remove(temporary, error);
    refuse(file, failed.code().message());
  } catch (const IoError&) {
    fs::remove(temporary, error);
    throw;
  }
  return true;
}

void write_standard_output(std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) refuse("standard output", std::strerror(errno));
}

}  // namespace impact_damper
