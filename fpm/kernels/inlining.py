"""How kernels are compiled: into their callers only.

numba makes machine code of every function that it compiles, and optimises each together with all
that it calls. Kernels become part of what the loop calls at a hook, or of the loop, which are
optimised whole in the end: for them both are left out, which halves what compiling takes."""

from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher
from numba.core.typing.context import BaseContext


class _InlinedLibrary(JITCodeLibrary):
    """The code of a kernel, of which no machine code is made."""

    def _optimize_final_module(self):
        """Optimise nothing: the code is optimised with that of its callers."""

    def _finalize_final_module(self):
        self._finalized = True

    def get_pointer_to_function(self, name):
        return 0

    @property
    def codegen(self):
        """Object by which numba gives machine code its environment in Python: none is needed."""
        return self

    def set_env(self, name, env):
        """Set no environment: kernels use nothing of Python."""


class InlinedCompiler(Compiler):
    """numba's compiler for kernels, functions that become part of their callers and are never
    called from Python: no machine code is made of them alone. typing, target, library, rest: as
    numba passes them; library is replaced."""

    def __init__(self, typing: BaseContext, target, library, *rest):
        super().__init__(typing, target, _InlinedLibrary(target.codegen(), "inlined"), *rest)


class InlinedKernel(CPUDispatcher):
    """A compiled kernel, as numba sees it: compiled once for all constant arguments of a type."""

    def get_call_template(self, args, kws):
        return super().get_call_template(tuple(map(types.unliteral, args)), kws)
