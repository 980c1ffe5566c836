// Preloaded into the program: stops its process group while a file is being written, so that a kill can meet
// it there. Undisturbed such a moment lasts microseconds, and is hardly ever met.
//
// Each file passes five points: opened, half of it written, all written, about to be renamed, renamed. The
// environment variable HOLD_AT says at which to stop, counted from 0 over all files of a process.
#include <dlfcn.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

template <class Function>
Function* replaced(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool is_temporary(const char* path) { return std::string_view(path).ends_with(".tmp"); }

void pass_point() {
  static const char* const at = std::getenv("HOLD_AT");
  static int passed = 0;
  if (at && passed++ == std::atoi(at)) ::kill(0, SIGSTOP);
}

std::FILE* held = nullptr;  // the stream of the file that is being written

}  // namespace

extern "C" std::FILE* fopen(const char* path, const char* mode) {
  static auto* const next = replaced<std::FILE*(const char*, const char*)>("fopen");
  std::FILE* const stream = next(path, mode);
  if (stream && is_temporary(path)) {
    held = stream;
    pass_point();
  }
  return stream;
}

extern "C" std::size_t fwrite(const void* data, std::size_t size, std::size_t count, std::FILE* stream) {
  static auto* const next =
      replaced<std::size_t(const void*, std::size_t, std::size_t, std::FILE*)>("fwrite");
  if (stream != held || size != 1) return next(data, size, count, stream);
  const std::size_t half = count / 2;
  std::size_t written = next(data, 1, half, stream);
  std::fflush(stream);
  pass_point();
  written += next(static_cast<const char*>(data) + half, 1, count - half, stream);
  std::fflush(stream);
  pass_point();
  return written;
}

extern "C" int rename(const char* from, const char* to) noexcept {
  static auto* const next = replaced<int(const char*, const char*)>("rename");
  if (!is_temporary(from)) return next(from, to);
  held = nullptr;
  pass_point();
  const int result = next(from, to);
  pass_point();
  return result;
}
