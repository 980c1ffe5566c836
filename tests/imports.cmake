# Fails if one of FILES, objects, libraries and programs as NM reads them, imports a transcendental function of
# the C library: its last bits depend on the library's version and on the processor (src/impact_damper/math/
# elementary_kernels.hpp). Not among them: sqrt, fmod, remainder, ceil, floor, round, trunc, rint, fabs, copysign, whose
# results the standard fixes to the last bit. fma is among them: without an instruction for it, it is slow.
set(real
  sin cos tan sincos sinpi cospi tanpi asin acos atan atan2 sinh cosh tanh asinh acosh atanh
  exp exp2 exp10 pow10 expm1 log log2 log10 log1p pow powi cbrt hypot
  erf erfc tgamma lgamma gamma j0 j1 jn y0 y1 yn fma)
set(complex
  cabs carg cexp clog clog10 cpow csqrt csin ccos ctan casin cacos catan csinh ccosh ctanh casinh cacosh catanh)
list(JOIN real "|" real)
list(JOIN complex "|" complex)
# With the suffixes of float, long double and the types with a width, by which names a compiler may call them.
set(pattern "^(__)?(${real}|${complex})(f|l|f16|f32|f64|f128|f32x|f64x)?(_r)?(_finite)?(@.*)?$")

set(found)
foreach(file IN LISTS FILES)
  # Of a program what it leaves to shared libraries, of anything else what it does not define itself.
  execute_process(COMMAND ${NM} -u ${file} OUTPUT_VARIABLE symbols RESULT_VARIABLE status ERROR_VARIABLE error)
  if(NOT status EQUAL 0 OR symbols STREQUAL "")
    message(FATAL_ERROR "${NM} -u ${file}: no symbols: ${error}")
  endif()
  string(REPLACE "\n" ";" lines "${symbols}")
  set(member ${file})
  foreach(line IN LISTS lines)
    if(line MATCHES "^[^ ]+:$")
      set(member ${line})
    elseif(line MATCHES " [Uw] ([^ ]+)$")
      set(symbol ${CMAKE_MATCH_1})
      if(symbol MATCHES "${pattern}")
        list(APPEND found "${member} ${symbol}")
      endif()
    endif()
  endforeach()
endforeach()
if(found)
  list(JOIN found "\n  " found)
  message(FATAL_ERROR "imported from the C library, where elementary.hpp has the project's own:\n  ${found}")
endif()
