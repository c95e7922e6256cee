"""Studies of where the method holds and what it costs: `snakemake extremes`, `snakemake accuracy`.

Every study is a short file that runs scenes through the public interface of fpm and returns rows
(rows.py); the scripts in workflow/scripts write them to results/<study>/.
"""
