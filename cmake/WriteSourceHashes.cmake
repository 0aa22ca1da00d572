# Script: writes a C++ file with one hash for the sources of every culler family and one for the judge.
#   cmake -D SOURCE_DIR=… -D FAMILIES=a:algorithms/a,b:algorithms/b+algorithms/c -D TRUTH_FAMILIES=b -D OUTPUT=file -P WriteSourceHashes.cmake
# A family's answers depend on its own folders and on the layers below them, those of TRUTH_FAMILIES on the
# judge too; the judge's on itself and the same layers. A mended family gets another hash, the others keep
# theirs.

cmake_policy(VERSION 3.25)

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

set(layers common/simd common/geometry common/scene common/spatial common/raster common/render common/culler)
string(REPLACE "," ";" families "${FAMILIES}")
string(REPLACE "," ";" truth_families "${TRUTH_FAMILIES}")
set(entries "")
foreach(entry IN LISTS families)
  string(REGEX MATCH "^([^:]+):(.+)$" matched "${entry}")
  set(family "${CMAKE_MATCH_1}")
  set(folders ${layers})
  string(REPLACE "+" ";" own_folders "${CMAKE_MATCH_2}")
  list(APPEND folders ${own_folders})
  if(family IN_LIST truth_families)
    list(APPEND folders common/judge)
  endif()
  hash_folders(hash ${folders})
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
