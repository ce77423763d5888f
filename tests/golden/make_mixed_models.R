# Makes tests/golden/mixed_models.json: linear mixed models by lme4 (REML), random intercept per group. Run from the project's root:
#   Rscript tests/golden/make_mixed_models.R > tests/golden/mixed_models.json
# Needs r-cran-lme4.
suppressMessages(library(lme4))

number <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(number(x), collapse = ", "), "]")

case <- function(name, subjects, trials, sd_subject, sd_rest, drop = 0, scale = 1) {
    d <- expand.grid(trial = seq_len(trials), subject = seq_len(subjects))
    d$condition <- (d$trial + d$subject) %% 3
    intercepts <- rnorm(subjects, 0, sd_subject)
    d$y <- 5 + 2 * (d$condition == 1) - 0.05 * d$trial + intercepts[d$subject] + rnorm(nrow(d), 0, sd_rest)
    d$y <- scale * d$y
    if (drop > 0) d <- d[-sample(nrow(d), drop), ]
    d$first <- as.numeric(d$condition == 1)
    d$second <- as.numeric(d$condition == 2)
    control <- lmerControl(optimizer = "bobyqa", optCtrl = list(rhoend = 1e-12), check.conv.singular = "ignore")
    fit <- lmer(y ~ first + second + trial + (1 | subject), data = d, REML = TRUE, control = control)
    variances <- as.data.frame(VarCorr(fit))$vcov
    cat(sprintf('  {"name": "%s",\n   "y": %s,\n   "first": %s,\n   "second": %s,\n   "trial": %s,\n   "subject": [%s],\n',
                name, list_of(d$y), list_of(d$first), list_of(d$second), list_of(d$trial),
                paste(d$subject, collapse = ", ")))
    cat(sprintf('   "estimates": %s,\n   "standard_errors": %s,\n   "variances": %s,\n   "log_likelihood": %s}',
                list_of(fixef(fit)), list_of(sqrt(diag(as.matrix(vcov(fit))))), list_of(variances),
                number(as.numeric(logLik(fit)))))
}

set.seed(28)
cat('{"made_with": "R', paste0(R.version$major, ".", R.version$minor, ", lme4 ", packageVersion("lme4")), '",\n "cases": [\n')
case("balanced", 10, 12, 1, 0.5)
cat(",\n")
case("unbalanced", 8, 15, 0.3, 1, 31)
cat(",\n")
case("no spread between subjects", 6, 9, 0, 1)
cat(",\n")
case("millimetres", 12, 6, 1, 2, 0, 1e-3)
cat("\n]}\n")
