// Files are written whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace impact_damper {

// Makes `text` the content of `file`: written under a temporary name in the same folder, then renamed. A file
// that already holds these bytes is left alone, time stamp included, so that whatever is made from it stays
// up to date; returns whether it was written. Symbolic links are followed; a device or pipe (/dev/null) is
// written to directly. Throws IoError, leaving nothing behind, if the folder does not exist, `file` is a
// directory, or the place cannot be written. Temporary files that killed processes have left beside `file`
// are removed. However the process ends, `file` is whole; after a failure of the machine that depends on its
// file system. Not to be called by two threads at once.
bool write_file(const std::filesystem::path& file, std::string_view text);

// Writes, in the same way, a text that is longer than memory: produce(add) is called once and adds it in
// pieces. What `file` holds already is not compared. What `produce` throws leaves `file` as it was.
using AddText = std::function<void(std::string_view piece)>;
void write_file_in_pieces(const std::filesystem::path& file,
                          const std::function<void(const AddText&)>& produce);

// Writes, in the same way, a file through a library: make(temporary) writes it there. `file` must not be a
// device or a pipe.
void write_file_by(const std::filesystem::path& file,
                   const std::function<void(const std::filesystem::path& temporary)>& make);

// For use before a long computation: throws the IoError of write_file if it can be foreseen, as `file` is a
// directory, or its folder is missing or not writable.
void require_writable(const std::filesystem::path& file);

// For a signal handler that ends the process: removes the temporary file of a write_file in progress.
void remove_unfinished_file() noexcept;

// Writes to standard output. Throws IoError if that fails, as for a full disk behind it.
void write_standard_output(std::string_view text);

}  // namespace impact_damper
