# family = "forging"
# tries = "An AST transformer of IPython replaces each call of check by the number of full marks."
# could_earn = "All points, where a cell's value is the grade."
# undefended = "In stock nbgrader 0.9.5 it earned full marks."

# %% extra
import ast


class FullMarks(ast.NodeTransformer):
    def visit_Call(self, node):
        if getattr(node.func, "id", "") == "check":
            return ast.copy_location(ast.Constant(10.0), node)
        return self.generic_visit(node)


get_ipython().ast_transformers.append(FullMarks())
