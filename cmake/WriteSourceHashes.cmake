# Script: writes a C++ file with one hash for the sources of every culler family and one for the judge.
#   cmake -D SOURCE_DIR=… -D FAMILIES=a,b -D OUTPUT=file -P WriteSourceHashes.cmake
# A family's answers depend on its own folder and on the layers below it; the judge's on itself and the
# same layers. Tests of a cell's key rely on it: a mended family gets another hash, the others keep theirs.

function(hash_folders result)
  set(text "")
  foreach(folder IN LISTS ARGN)
    file(GLOB_RECURSE files "${SOURCE_DIR}/${folder}/*.h" "${SOURCE_DIR}/${folder}/*.cpp")
    list(SORT files)
    foreach(file IN LISTS files)
      file(SHA256 "${file}" hash)
      file(RELATIVE_PATH name "${SOURCE_DIR}" "${file}")
      string(APPEND text "${name} ${hash}\n")
    endforeach()
  endforeach()
  string(SHA256 hash "${text}")
  set(${result} "${hash}" PARENT_SCOPE)
endfunction()

set(layers common/geometry common/scene common/render common/culler)
string(REPLACE "," ";" families "${FAMILIES}")
set(entries "")
foreach(family IN LISTS families)
  hash_folders(hash ${layers} algorithms/${family})
  string(APPEND entries "      {\"${family}\", \"${hash}\"},\n")
endforeach()
hash_folders(judge_hash ${layers} common/judge)

set(content
"// Written by CMake from the sources.
#include \"experiments/context/sources.h\"

namespace vislab {

const std::map<std::string, std::string, std::less<>>& family_source_hashes() {
  static const std::map<std::string, std::string, std::less<>> hashes{
${entries}  };
  return hashes;
}

const std::string& judge_source_hash() {
  static const std::string hash = \"${judge_hash}\";
  return hash;
}

}  // namespace vislab
")
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "${content}" @ONLY)
