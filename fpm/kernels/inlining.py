"""How kernels are compiled: into their callers only.

numba makes machine code of every function that it compiles, and optimises each together with all
that it calls. Kernels become part of what the loop calls at a hook, or of the loop: these are
optimised whole, and alone get machine code. That takes insides of numba, tried with 0.62 and 0.68.
Without the library, compiler and dispatcher below, compiling takes 1.6 times as long for the solar
array and 1.7 times for the telescope, without the library of kernels alone 1.3 times for Bennett's
linkage; with operators typed by `numba.extending`, 1.4 times for the boom. Its public `intrinsic`
takes 1.1 times as long as one with a table of signatures would, and is used."""

from collections.abc import Callable, Sequence

from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher
from numba.core.typing.templates import ConcreteTemplate, Signature, infer_global


class KernelLibrary(JITCodeLibrary):
    """The code of a kernel, of which no machine code is made."""

    def _optimize_functions(self, ll_module):
        """Simplify functions a little; the rest is done when they are part of their callers."""
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            passes, builder = self._codegen._function_pass_manager(opt=1)
            passes.run(function, builder)

    def _optimize_final_module(self):
        """Optimise nothing: the code is optimised with that of its callers."""

    def _finalize_final_module(self):
        self._finalized = True

    def _get_module_for_linking(self):
        """Return the code itself, which goes into its callers: numba would copy it."""
        self._ensure_finalized()
        for function in self._final_module.functions:
            if function.linkage.name == "external" and not function.is_declaration:
                function.linkage = "linkonce_odr"
        return self._final_module

    def get_pointer_to_function(self, name):
        self._ensure_finalized()
        return 0

    @property
    def codegen(self):
        """Object by which numba gives machine code its environment in Python: none is needed."""
        return self

    def set_env(self, name, env):
        """Set no environment: kernels use nothing of Python."""


class EntryLibrary(KernelLibrary):
    """The code of what the loop calls, or of the loop; object_code: of the machine."""

    def _optimize_final_module(self):
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self.object_code = self._codegen._tm.emit_object(self._final_module)
        self._finalized = True


class KernelCompiler(Compiler):
    """numba's compiler for kernels, which become part of their callers: no machine code is made of
    them alone, as `library` is replaced."""

    library = KernelLibrary

    def __init__(self, typing, target, library, *rest):
        super().__init__(typing, target, self.library(target.codegen(), "kernel"), *rest)


class EntryCompiler(KernelCompiler):
    """numba's compiler for what the loop calls, and for the loop: machine code is made."""

    library = EntryLibrary


class InlinedKernel(CPUDispatcher):
    """A compiled kernel, as numba sees it: compiled once for all constant arguments of a type."""

    def get_call_template(self, args, kws):
        return super().get_call_template(tuple(map(types.unliteral, args)), kws)


def type_operator(operation: Callable, cases: Sequence[Signature]) -> None:
    """Let numba type an operator for lanes and vectors by one look-up, before all that it has of
    its own. operation: of the module `operator`; cases: signatures, which are lowered already."""
    signatures = {case.args: case for case in cases}

    class Operator(ConcreteTemplate):
        def apply(self, args, kws):
            numbers = {a for a in args if isinstance(a, types.Number | types.Boolean)}
            if len(numbers) < len(args) and not numbers <= {types.float64, types.int64}:
                return super().apply(args, kws)  # as a product with a truth value
            return signatures.get(args)

    # Those for one target are tried before those for any.
    Operator.cases, Operator.metadata = cases, {"target": "cpu"}
    infer_global(operation)(Operator)
