# Trials of `thimble study` with R alone (Debian: r-base-core).
#
#     thimble study --out out/study && Rscript examples/analysis/trials.R out/study
folder <- commandArgs(trailingOnly = TRUE)[1]
# "#" begins a comment; an empty field becomes NA.
trials <- read.csv(file.path(folder, "trials.csv"), comment.char = "#")

# One value per subject and condition first.
subjects <- aggregate(penetration_mean_m ~ subject + modality + delay_s, data = trials, FUN = mean)
print(aggregate(penetration_mean_m ~ modality + delay_s, data = subjects,
                FUN = function(x) c(mean = mean(x), sd = sd(x), n = length(x))))

# One-way analysis of variance with repeated measures, as the paper has it, at each delay. Without a correction for
# sphericity: for that, and for effect sizes, see `thimble analyse` or the package afex.
for (delay_s in unique(subjects$delay_s)) {
  at_delay <- subjects[subjects$delay_s == delay_s, ]
  at_delay$subject <- factor(at_delay$subject)
  at_delay$modality <- factor(at_delay$modality)
  if (nlevels(at_delay$modality) < 2 || nlevels(at_delay$subject) < 2) next
  cat("\ndelay", delay_s, "s\n")
  print(summary(aov(penetration_mean_m ~ modality + Error(subject / modality), data = at_delay)))
}
